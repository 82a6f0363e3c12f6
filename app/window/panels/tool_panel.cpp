#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/panels.h"
#include "app/window/panels/slider.h"
#include "app/window/scene_edits.h"

namespace fettle::app {
namespace {

using render::PanelColour;

constexpr int kStrengthLines = 3;

void toolButtons(const PanelContext& context, const Stylus& stylus, const Lasso& lasso) {
  // As many buttons per line as fit.
  bool first = true;
  const auto button = [&](const char* name, Action action, bool on) {
    if (!first) sameLineIfFits(name);
    first = false;
    if (on) ImGui::PushStyleColor(ImGuiCol_Button, colourOf(PanelColour::kButtonHeld));
    if (ImGui::Button(labelOf(name))) context.act(action);
    if (on) {
      ImGui::PopStyleColor();
      // Two blues alone are too much alike.
      ImGui::GetWindowDrawList()->AddRect(ImGui::GetItemRectMin(), ImGui::GetItemRectMax(),
                                          colourOf(PanelColour::kTick), ImGui::GetStyle().FrameRounding, 0,
                                          2.0F);
    }
    tip(action);
  };
  const auto draws = [&](Lasso::Shape shape) { return lasso.active() && lasso.shape() == shape; };
  button(textOf("View"), Action::kNavigate, !stylus.on() && !lasso.active());
  for (const haptic::ToolRow& row : haptic::kToolRows)
    button(std::string(row.title).c_str(), actionOf(row.tool),
           stylus.on() && context.client.tool() == row.tool);
  button(textOf("Lasso"), Action::kLasso, draws(Lasso::Shape::kFree));
  button(textOf("Box"), Action::kBox, draws(Lasso::Shape::kBox));
}

// The profile of a brush, from rim to rim.
void drawFalloff(haptic::Falloff falloff, const ImVec2& corner, const ImVec2& size) {
  constexpr int kSteps = 48;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const auto& weight = haptic::rowOf(falloff).weight;
  const float foot = corner.y + size.y;
  const auto at = [&](int i) {
    const double way = std::abs(2.0 * i / kSteps - 1.0);
    return ImVec2(corner.x + size.x * static_cast<float>(i) / kSteps,
                  foot - (size.y - 1.0F) * static_cast<float>(weight(way)));
  };
  const ImU32 filled = colourOf(PanelColour::kFieldPointed), line = colourOf(PanelColour::kText);
  for (int i = 0; i < kSteps; ++i) {
    const ImVec2 a = at(i), b = at(i + 1);
    list.AddQuadFilled(ImVec2(a.x, foot), a, b, ImVec2(b.x, foot), filled);
  }
  for (int i = 0; i < kSteps; ++i) list.AddLine(at(i), at(i + 1), line, 1.5F);
}

// How smoothing falls towards the rim: a list of names, each with its profile.
void falloffField(const PanelContext& context) {
  haptic::Scene scene = context.client.scene();
  const haptic::FalloffRow& now = haptic::rowOf(scene.brush_falloff);
  const float line = ImGui::GetTextLineHeight();
  const ImVec2 curve(3.0F * line, line);
  const std::string says =
      trFormat("How smoothing falls from the middle of the brush to its rim: {}.", tr(now.hint));
  fieldName("falloff", says);
  const bool opened = beginList("##falloff", std::string(tr(now.word)).c_str());
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  if (!opened) {
    const float arrow = ImGui::GetFrameHeight();
    drawFalloff(scene.brush_falloff,
                ImVec2(high.x - arrow - curve.x - 6.0F, low.y + 0.5F * (high.y - low.y - curve.y)), curve);
    explain(says);
    return;
  }
  for (const haptic::FalloffRow& row : haptic::kFalloffRows) {
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const float room = ImGui::GetContentRegionAvail().x;
    if (ImGui::Selectable(labelOf(std::string(row.word).c_str()), row.falloff == scene.brush_falloff)) {
      scene.brush_falloff = row.falloff;
      applyScene(context.client, scene, context.notices);
    }
    drawFalloff(row.falloff, ImVec2(corner.x + room - curve.x, corner.y), curve);
    explain(row.hint);
  }
  ImGui::EndCombo();
}

void spacingField(const PanelContext& context) {
  haptic::Scene scene = context.client.scene();
  auto spacing = static_cast<float>(scene.brush_spacing);
  constexpr const char* kSays = textOf(
      "All the time: the longer the tip stays, the smoother it gets. Else it acts again only when it has "
      "moved by "
      "so many radii of the brush.");
  const bool changed = field("spacing", kSays, [&] {
    return slider("##spacing", spacing, 0.0F, static_cast<float>(haptic::kMaxBrushSpacing),
                  spacing > 0.0F ? trPrintf("%.2f radii") : tr("all the time"));
  });
  if (!changed) return;
  scene.brush_spacing = std::round(100.0 * static_cast<double>(spacing)) / 100.0;
  applyScene(context.client, scene, context.notices);
}

// What pressing so deep does, in words.
void strengthText(LoopClient& client) {
  const haptic::Scene& scene = client.scene();
  const double pressed_n = client.mouse()->pressMm() * scene.stiffness_n_per_mm;
  const double strength = std::clamp(pressed_n / scene.force_limit_n, 0.0, 1.0);
  const char* const words = strength < 1.0 / 3.0   ? tr("lightly: near samples count most")
                            : strength < 2.0 / 3.0 ? tr("firmly")
                                                   : tr("hard: all samples around count alike");
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextDisabled(
      "%s", trFormat("pressed so deep it smooths {} ({:.0f} % of the force limit)", words, 100.0 * strength)
                .c_str());
  ImGui::PopTextWrapPos();
}

void brushFields(const PanelContext& context) {
  LoopClient& client = context.client;
  const engine::Grid& grid = client.field().grid();
  const double cell = std::max(grid.spacingXMm(), grid.spacingYMm());
  const double samples = brushRadius(client);
  beginFields();
  auto radius = static_cast<float>(samples);
  if (field("radius", "How far the brush reaches around the tip; [ and ] change it, too.", [&] {
        return slider("##radius", radius, 0.0F, static_cast<float>(haptic::kMaxBrushRadius),
                      trPrintf("%.0f samples"));
      }))
    setBrushRadius(client, std::round(static_cast<double>(radius)), context.notices);
  double radius_mm = samples * cell;
  if (field("", "The same radius as a length.", [&] {
        return typeLength("##radius_mm", radius_mm, 0.0, haptic::kMaxBrushRadius * cell,
                          ofMillimetres(context.units.length, grid.lateral_unit.mm));
      }))
    setBrushRadius(client, radius_mm / cell, context.notices);
  const bool smooths = !haptic::isMarkTool(client.tool());
  ImGui::BeginDisabled(!smooths);
  falloffField(context);
  spacingField(context);
  ImGui::EndDisabled();
  if (client.mouse() != nullptr) {
    auto depth = static_cast<float>(client.mouse()->pressMm() / cell);
    if (field("depth",
              "How far below the surface the mouse presses the tip; the wheel changes it while it presses.",
              [&] { return slider("##depth", depth, 0.0F, 4.0F, trPrintf("%.2f cells")); }))
      setPressDepth(client, static_cast<double>(depth) * cell);
  }
  haptic::Scene scene = client.scene();
  if (limitField(context, scene.max_change, Action::kKeepWithin)) applyScene(client, scene, context.notices);
  endFields();
  if (client.mouse() == nullptr) return;
  beginPlace("##strength", kStrengthLines);
  if (smooths) strengthText(client);
  endPlace();
}

}  // namespace

void toolPanel(const PanelContext& context, const Stylus& stylus, const Marking& marking,
               const Display& display) {
  toolButtons(context, stylus, marking.lasso());
  brushFields(context);
  actionTick("marks", display.marks, Action::kShowMarks, context.act);
  sameLineIfFits("upside down", ItemKind::kTick);
  actionTick("upside down", context.client.scene().invert, Action::kInvert, context.act);
  actionButton("Clear marks", Action::kClearMarks, context.act);
  sameLineIfFits("Invert marks");
  actionButton("Invert marks", Action::kInvertMarks, context.act);
}

}  // namespace fettle::app
