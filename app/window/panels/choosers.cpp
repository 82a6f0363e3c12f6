// Choice of accuracy, with the cost and the error of each choice on this scan.
#include <algorithm>
#include <string_view>

#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"
#include "app/window/scene_edits.h"
#include "app/window/screen_text.h"
#include "haptic/contact/sphere_tip.h"

namespace fettle::app {
namespace {

struct Entry {
  const char* name;
  std::string off;  // its error; empty: not measured
  std::string cost;
};

// A list to choose from, figures next to the names. Returns the chosen entry, or -1. `opened`: the list is
// open.
int chooser(const char* id, const std::string& now, const std::vector<Entry>& entries, const char* off_title,
            const char* cost_title, bool& opened) {
  int chosen = -1;
  opened = beginList(id, std::string(tr(std::string_view(now))).c_str(), ImGuiComboFlags_HeightLargest);
  if (!opened) return chosen;
  std::string widest;
  for (const Entry& entry : entries)
    if (const std::string_view name = tr(entry.name); widest.size() < name.size()) widest = name;
  if (ImGui::BeginTable("##choices", 3, ImGuiTableFlags_SizingFixedFit | ImGuiTableFlags_RowBg)) {
    // As wide as the figures will need once they are measured.
    const auto column = [](const char* title, const std::string& text) {
      ImGui::TableSetupColumn(tr(title), ImGuiTableColumnFlags_WidthFixed,
                              ImGui::CalcTextSize(text.c_str()).x + ImGui::GetFontSize());
    };
    column(textOf("choice"), widest);
    column(off_title, trFormat("{:.2g} px, {:.2g} codes", 12.5, 0.025));
    column(cost_title, "33.4 us");
    ImGui::TableHeadersRow();
    for (std::size_t i = 0; i < entries.size(); ++i) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      if (ImGui::Selectable(labelOf(entries[i].name), now == entries[i].name,
                            ImGuiSelectableFlags_SpanAllColumns))
        chosen = static_cast<int>(i);
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(entries[i].off.c_str());
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(entries[i].cost.c_str());
    }
    ImGui::EndTable();
  }
  ImGui::EndCombo();
  return chosen;
}

// Below a chooser: the figures of the choice, or the progress of measuring.
bool measuringLine(const auto& run, const char* cancel_id) {
  if (!run.busy()) return false;
  workBar(run.progress(), -ImGui::GetFontSize() * 5.0F, textOf("measuring on this scan"));
  ImGui::SameLine();
  return ImGui::Button(labelOf(cancel_id));
}

void wrapped(const std::string& text) {
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextDisabled("%s", text.c_str());
  ImGui::PopTextWrapPos();
}

std::string duration(double ns) {
  return ns < 999.5 ? trFormat("{:.0f} ns", ns) : screenText(trFormat("{:.3g} us", 1e-3 * ns));
}

// Lengths that may be only rounding, beside a spacing of `cell_mm`.
std::string length(double mm, double cell_mm, const render::ShownUnit& of_mm) {
  return mm < 1e-6 * cell_mm ? "0 " + of_mm.name : lengthText(mm, of_mm, 2);
}

bool sameChoice(const haptic::Scene& scene, const trials::ContactChoice& choice, const engine::Grid& grid) {
  const haptic::Scene chosen = choice.in(scene, grid);
  if (chosen.tip != scene.tip) return false;
  if (scene.tip == haptic::TipShape::kSphere)
    return chosen.tip_radius_mm == scene.tip_radius_mm && chosen.search_rounds == scene.search_rounds;
  if (chosen.level != scene.level) return false;
  if (scene.level == haptic::ContactLevel::kCertified)
    return chosen.certified_radius_cells == scene.certified_radius_cells;
  return scene.level == haptic::ContactLevel::kPaper || chosen.search_rounds == scene.search_rounds;
}

std::string described(const haptic::Scene& scene, const render::ShownUnit& of_mm) {
  if (scene.tip == haptic::TipShape::kSphere)
    return scene.search_rounds > haptic::kSphereSteps
               ? trFormat("ball, radius {}", lengthText(scene.tip_radius_mm, of_mm, 3))
               : trFormat("ball, radius {}, {} steps", lengthText(scene.tip_radius_mm, of_mm, 3),
                          scene.search_rounds - 1);
  if (scene.level == haptic::ContactLevel::kCertified)
    return trFormat("certified, {} cells", scene.certified_radius_cells);
  if (scene.level == haptic::ContactLevel::kDescent)
    return trFormat("descent, {} steps per tick", scene.search_rounds - 1);
  return std::string(tr(haptic::levelName(scene.level)));
}

}  // namespace

void contactChooser(const PanelContext& context, ChoiceCosts& costs) {
  LoopClient& client = context.client;
  haptic::Scene scene = client.scene();
  const engine::Grid& grid = client.field().grid();
  const std::span<const trials::ContactChoice> choices = trials::contactChoices();
  const std::vector<trials::ContactFigures>& measured = costs.contact();
  std::vector<Entry> entries;
  const render::ShownUnit of_mm = ofMillimetres(context.units.length, grid.lateral_unit.mm);
  const auto size = [&](double mm) {
    return length(mm, std::max(grid.spacingXMm(), grid.spacingYMm()),
                  ofMillimetres(context.units.change, grid.height_unit.mm));
  };
  std::string now = described(scene, of_mm), what;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    Entry& entry = entries.emplace_back(Entry{choices[i].name, "", ""});
    const bool chosen = sameChoice(scene, choices[i], grid);
    if (chosen) now = choices[i].name;
    if (measured.empty() || measured[i].ticks == 0) continue;
    const trials::ContactFigures& m = measured[i];
    entry.off = size(m.mean_mm);
    entry.cost = duration(m.ns);
    if (chosen)
      what = trFormat(
          "error of the contact point {} on average, {} at worst, {:.2g} % of them not the nearest; {} per "
          "tick",
          size(m.mean_mm), size(m.worst_mm), 100.0 * m.wrong, duration(m.ns));
  }
  bool opened = false;
  int chosen = -1;
  constexpr const char* kSays = textOf(
      "How exactly the point is found that the tip touches. What is more exact takes longer in each tick; "
      "the "
      "list says how long on this scan.");
  (void)field("contact", kSays, [&] {
    chosen = chooser("##contact", now, entries, textOf("error"), textOf("per tick"), opened);
    return false;
  });
  if (opened && measured.empty() && !costs.contactRun().busy()) costs.measureContact(client.field());
  if (chosen >= 0) {
    scene = choices[static_cast<std::size_t>(chosen)].in(scene, grid);
    if (const auto problem = scene.tip == haptic::TipShape::kSphere
                                 ? haptic::sphereProblem(scene.tip_radius_mm, grid)
                                 : std::nullopt)
      context.notices.push_back({*problem, ""});
    else
      applyScene(client, scene, context.notices);
  }
  if (measuringLine(costs.contactRun(), textOf("Cancel##contact"))) costs.cancelContact();
  if (!what.empty()) wrapped(what);
}

void detailChooser(const PanelContext& context, Display& display, WindowPicture& picture,
                   const render::View& view, ChoiceCosts& costs) {
  const std::span<const trials::DetailChoice> choices = detailChoices();
  const std::vector<trials::DetailFigures>& measured = costs.detail();
  std::vector<Entry> entries;
  std::string now = trFormat("{} vertices", display.vertices), what;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    Entry& entry = entries.emplace_back(Entry{choices[i].name, "", ""});
    const bool chosen = display.vertices == choices[i].vertices;
    if (chosen) now = choices[i].name;
    if (measured.empty()) continue;
    const trials::DetailFigures& m = measured[i];
    entry.off = trFormat("{:.2g} px, {:.2g} codes", m.bound_px, m.mean_codes);
    entry.cost = trFormat("{:.3g} ms", m.ms);
    if (chosen)
      what = trFormat(
          "surface within {:.2g} px, colour error {:.2g} of 255 on average, {:.2g} % of pixels by more than "
          "16; {:.3g} ms per whole frame. When nothing moves it is drawn within 1 px",
          m.bound_px, m.mean_codes, 100.0 * m.far_off, m.ms);
  }
  bool opened = false;
  int chosen = -1;
  constexpr const char* kSays = textOf(
      "With how many vertices the surface is drawn while it moves: more are sharper and slower. At rest it "
      "is "
      "drawn within a pixel whatever is chosen.");
  (void)field("detail", kSays, [&] {
    chosen = chooser("##detail", now, entries, textOf("error"), textOf("per frame"), opened);
    return false;
  });
  if (opened && measured.empty() && !costs.detailRun().busy() && view.width > 0)
    costs.measureDetail(context.client.field(), view);
  if (chosen >= 0) {
    display.vertices = choices[static_cast<std::size_t>(chosen)].vertices;
    picture.requestRedraw();
  }
  if (measuringLine(costs.detailRun(), textOf("Cancel##detail"))) costs.cancelDetail();
  wrapped(what.empty() ? trFormat("surface within {:.2g} px now", picture.figures().bound_px) : what);
}

}  // namespace fettle::app
