#include <algorithm>
#include <initializer_list>
#include <string>

#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"
#include "app/window/scene_edits.h"
#include "app/window/screen_text.h"

namespace fettle::app {
namespace {

void text(const std::string& what) {
  ImGui::TextUnformatted(screenText(what).c_str());
}

// The first of these that the line has room for, behind it what the cursor is on where that fits, too.
void textThatFits(std::initializer_list<const char*> says, const std::string& place) {
  const float room = ImGui::GetContentRegionAvail().x;
  const auto fits = [room](const std::string& line) {
    return ImGui::CalcTextSize(screenText(line).c_str()).x <= room;
  };
  for (const std::string& behind : {place, std::string()})
    for (const char* each : says)
      if (std::string line = each + behind; fits(line)) return text(line);
  text(*(says.end() - 1));
}

// Returns whether the user cancelled.
bool statusWork(const WorkProgress& progress, float width, const char* what) {
  workBar(progress, width, what);
  ImGui::SameLine();
  return ImGui::SmallButton(labelOf("Cancel"));
}

// What is typed or moved beyond the ends stays at them, and says so.
const char* endOfRadius(double samples) {
  return samples >= haptic::kMaxBrushRadius ? tr(" (the largest)") : samples < 1.0 ? tr(" (one sample)") : "";
}

const char* endOfDepth(const haptic::MouseStylus& mouse) {
  return mouse.pressMm() >= mouse.deepestMm() ? tr(" (the largest)")
         : mouse.pressMm() <= 0.0             ? tr(" (none)")
                                              : "";
}

std::string brushText(const BrushAdjustment& brush, LoopClient& client) {
  const std::string now =
      brush.of() == BrushAdjustment::Of::kRadius
          ? trFormat("brush radius {:.3g} samples{}", brushRadius(client), endOfRadius(brushRadius(client)))
          : trFormat("press depth {}{}", lengthText(client.mouse()->pressMm(), brush.depthUnit()),
                     endOfDepth(*client.mouse()));
  const std::string typed = brush.typed().empty() ? ""
                            : brush.understood()  ? " [" + brush.typed() + "]"
                                                  : trFormat(" [not understood: {}]", brush.typed());
  return trFormat("{}{}: move or type, Enter or left button keeps it, Esc or right button leaves it", now,
                  typed);
}

// Of the surface under the cursor, whatever the mouse holds: a tenth of a sample across, and four digits of the span
// of heights.
std::string placeText(const Parts& parts) {
  const WindowPicture& picture = parts.picture;
  if (!picture.made() || !picture.inside(parts.cursor.x, parts.cursor.y)) return {};
  const auto under = picture.pick(parts.cursor.x, parts.cursor.y);
  if (!under) return {};
  const engine::Grid& grid = parts.document.client()->field().grid();
  const render::ShownUnit &length = parts.units.length, &height = parts.units.height;
  const int across = render::decimalsFor(0.1 * std::min(grid.spacing_x, grid.spacing_y) * length.per_unit);
  const auto place = [&](double origin, double mm) {
    return fmt::format("{:.{}f}", (origin + mm / grid.lateral_unit.mm) * length.per_unit, across);
  };
  return fmt::format("   x {}  y {} {}  z {:.{}f} {}", place(grid.origin_x, under->position_mm.x),
                     place(grid.origin_y, under->position_mm.y), length.name,
                     under->position_mm.z / grid.height_unit.mm * height.per_unit,
                     render::decimalsFor(parts.units.height_step), height.name);
}

// The open document, how it is stored, and the cursor's position.
std::string documentText(const Parts& parts) {
  if (!parts.document.isOpen()) return parts.feedback.status;
  return parts.saving.statusText(parts.feedback.status, parts.document) + placeText(parts);
}

void content(Parts& parts) {
  const Lasso& lasso = parts.marking.lasso();
  const engine::EdgeSuggestion* const edges = parts.marking.edges.suggestion();
  if (parts.brush.active()) {
    text(brushText(parts.brush, *parts.document.client()));
  } else if (const auto& point = parts.plane_points.next()) {
    const ActionRow& key = rowOf(Action::kPlanePoint);
    text(trFormat(
        "plane through three points: click point {} of 3 on the surface, or {} at the cursor; Esc leaves",
        *point + 1, keyText(key.key, key.modifiers)));
  } else if (edges != nullptr) {
    text(trFormat(
        "suggested: {} lines; Enter takes them, Ctrl+[ and Ctrl+] fewer and more, M and U paint over "
        "them, Esc drops them",
        edges->lines));
  } else if (const auto saving = parts.saving.progress(parts.document)) {
    if (statusWork(*saving, 240.0F, textOf("saving"))) parts.saving.cancel(parts.document);
  } else if (parts.results.busy()) {
    if (statusWork(parts.results.progress(), 240.0F,
                   trFormat("writing {}", tr(parts.results.what())).c_str()))
      parts.results.cancel();
  } else if (parts.opening.coarse() != nullptr) {
    if (statusWork(parts.opening.progress(), 160.0F, textOf("reading"))) parts.opening.cancel();
    ImGui::SameLine();
    text(parts.opening.coarseText());
  } else if (parts.document.isOpen() && parts.opening.busy()) {
    if (statusWork(parts.opening.progress(), 240.0F, textOf("opening"))) parts.opening.cancel();
  } else if (lasso.active()) {
    // It stays on for long: what is under the cursor is said as well.
    // Large letters leave room for less.
    if (lasso.shape() == Lasso::Shape::kBox)
      textThatFits({tr("box after box: drag, or corners with arrows and Space; Enter marks, with Ctrl "
                       "unmarks; Esc or another tool ends it"),
                    tr("box after box: Enter marks, with Ctrl unmarks; Esc ends it"),
                    tr("Enter marks, with Ctrl unmarks; Esc ends it")},
                   placeText(parts));
    else
      textThatFits({tr("line after line: draw, or corners by click or arrows and Space; Enter or right "
                       "button marks, with Ctrl unmarks; Esc or another tool ends it"),
                    tr("line after line: Enter marks, with Ctrl unmarks; Esc ends it"),
                    tr("Enter marks, with Ctrl unmarks; Esc ends it")},
                   placeText(parts));
  } else if (parts.marking.edit.busy()) {
    if (statusWork(parts.marking.edit.progress(), 240.0F, parts.marking.edit.what().c_str()))
      parts.marking.edit.cancel();
  } else if (parts.marking.edges.busy()) {
    if (statusWork(parts.marking.edges.progress(), 240.0F, textOf("looking for edges")))
      parts.marking.edges.drop();
  } else if (PlaceTool& places = parts.marking.places; places.busy()) {
    if (statusWork(places.progress(), 240.0F, textOf("looking for places"))) places.drop();
  } else {
    text(documentText(parts));
  }
}

// What a device that gives force lacks, at the end of the line: its panel is folded mostly.
void deviceWord(const Parts& parts) {
  if (!parts.document.isOpen()) return;
  LoopClient& client = *parts.document.client();
  const haptic::LoopState state = client.state();
  const haptic::LinkState link = state.link;
  if (state.tick == 0 || !client.device().profile().gives_force || link == haptic::LinkState::kConnected)
    return;
  const std::string word =
      fmt::format("{}: {}", client.device().profile().name,
                  link == haptic::LinkState::kUncalibrated ? tr("not calibrated") : tr("not plugged in"));
  const float place =
      ImGui::GetWindowWidth() - ImGui::GetStyle().WindowPadding.x - ImGui::CalcTextSize(word.c_str()).x;
  ImGui::SameLine();
  ImGui::SetCursorPosX(std::max(ImGui::GetCursorPosX(), place));
  textIn(render::PanelColour::kProblem, word);
}

}  // namespace

void statusBar(Parts& parts) {
  const float height = ImGui::GetFrameHeight();
  ImGui::SetNextWindowPos(ImVec2(0.0F, ImGui::GetIO().DisplaySize.y - height));
  ImGui::SetNextWindowSize(ImVec2(ImGui::GetIO().DisplaySize.x, height));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(8.0F, 2.0F));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1.0F, 1.0F));
  ImGui::Begin("##status", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav);
  content(parts);
  deviceWord(parts);
  ImGui::End();
  ImGui::PopStyleVar(2);
}

void placeholder(Parts& parts, float width, const Act& act, PanelRequests& requests) {
  const bool announces = parts.announcesPicture();
  if (!announces && parts.seenGrid() != nullptr) return;
  ImGui::SetNextWindowPos(ImVec2(0.5F * width, 0.45F * ImGui::GetIO().DisplaySize.y), ImGuiCond_Always,
                          ImVec2(0.5F, 0.5F));
  ImGui::Begin("##empty", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus |
                   ImGuiWindowFlags_NoFocusOnAppearing);  // dialogs lie over it
  Opening& opening = parts.opening;
  if (announces) {
    ImGui::TextUnformatted(trFormat("{}: making the first picture", parts.document.fileName()).c_str());
  } else if (opening.busy()) {
    ImGui::TextUnformatted(opening.fileName().c_str());
    const WorkProgress progress = opening.progress();
    workBar(progress, 360.0F * static_cast<float>(parts.window.scale()),
            fmt::format("{} {:.0f} %", opening.stage(), 100.0 * progress.share).c_str());
    if (ImGui::Button(labelOf("Cancel"))) opening.cancel();
  } else {
    startPage(parts, act, requests);
  }
  ImGui::End();
}

}  // namespace fettle::app
