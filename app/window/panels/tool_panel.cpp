#include <algorithm>
#include <cmath>

#include <imgui.h>

#include "app/window/panels/panels.h"
#include "app/window/scene_edits.h"

namespace fettle::app {
namespace {

void toolButtons(const PanelContext& context, const Stylus& stylus, const Lasso& lasso) {
  // As many buttons per line as fit.
  bool first = true;
  const auto button = [&](const char* name, Action action, bool on) {
    if (!first) sameLineIfFits(name);
    first = false;
    if (on) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
    if (ImGui::Button(name)) context.act(action);
    if (on) ImGui::PopStyleColor();
    tip(action);
  };
  const auto draws = [&](Lasso::Shape shape) { return lasso.active() && lasso.shape() == shape; };
  button("View", Action::kNavigate, !stylus.on() && !lasso.active());
  for (const haptic::ToolRow& row : haptic::kToolRows)
    button(std::string(row.title).c_str(), actionOf(row.tool),
           stylus.on() && context.client.tool() == row.tool);
  button("Lasso", Action::kLasso, draws(Lasso::Shape::kFree));
  button("Box", Action::kBox, draws(Lasso::Shape::kBox));
}

void brushFields(const PanelContext& context) {
  LoopClient& client = context.client;
  const engine::Grid& grid = client.field().grid();
  const double cell = std::max(grid.spacingXMm(), grid.spacingYMm());
  const double samples = brushRadius(client);
  beginFields();
  auto radius = static_cast<float>(samples);
  if (field("radius", [&] {
        return ImGui::SliderFloat("##radius", &radius, 0.0F, static_cast<float>(haptic::kMaxBrushRadius),
                                  "%.0f samples", ImGuiSliderFlags_AlwaysClamp);
      }))
    setBrushRadius(client, std::round(static_cast<double>(radius)), context.notices);
  double radius_mm = samples * cell;
  if (field("", [&] {
        return typeLength("##radius_mm", radius_mm, 0.0, haptic::kMaxBrushRadius * cell,
                          ofMillimetres(context.units.length, grid.lateral_unit.mm));
      }))
    setBrushRadius(client, radius_mm / cell, context.notices);
  if (client.mouse() != nullptr) {
    auto depth = static_cast<float>(client.mouse()->pressMm() / cell);
    if (field("depth", [&] {
          return ImGui::SliderFloat("##depth", &depth, 0.0F, 4.0F, "%.2f cells",
                                    ImGuiSliderFlags_AlwaysClamp);
        }))
      setPressDepth(client, static_cast<double>(depth) * cell);
  }
  haptic::Scene scene = client.scene();
  (void)field("keep within", [&] {
    actionTick("##within", scene.max_change.has_value(), Action::kKeepWithin, context.act);
    if (!scene.max_change) return false;
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1.0F);
    if (typeLength("##most", *scene.max_change, 0.0, 1e9, context.units.change))
      applyScene(client, scene, context.notices);
    return false;
  });
  endFields();
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
  if (marking.edit.busy()) {
    sameLineIfFits("marking ...");
    workBar(marking.edit.progress(), -1.0F, "marking");
  }
}

}  // namespace fettle::app
