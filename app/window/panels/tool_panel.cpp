#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <imgui.h>

#include "app/window/panels/panels.h"
#include "app/window/panels/widgets.h"
#include "app/window/scene_edits.h"

namespace fettle::app {

using haptic::Tool;

void toolPanel(const PanelContext& context, const Stylus& stylus, const Marking& marking,
               const Display& display) {
  LoopClient& touch = context.touch;
  // As many buttons in a line as there is room for.
  bool first = true;
  const auto button = [&](const char* name, Action action, bool on) {
    if (!first) besideOrBelow(name);
    first = false;
    if (on) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
    if (ImGui::Button(name)) context.act(action);
    if (on) ImGui::PopStyleColor();
    tip(action);
  };
  const Tool tool = touch.tool();
  const bool lasso = marking.lasso().active();
  const auto is = [&](Lasso::Shape shape) { return lasso && marking.lasso().shape() == shape; };
  button("View", Action::kNavigate, !stylus.on() && !lasso);
  button("Feel", Action::kFeel, stylus.on() && tool == Tool::kFeel);
  button("Smooth", Action::kSmooth, stylus.on() && tool == Tool::kSmooth);
  button("Mark", Action::kMark, stylus.on() && tool == Tool::kMark);
  button("Unmark", Action::kUnmark, stylus.on() && tool == Tool::kUnmark);
  button("Lasso", Action::kLasso, is(Lasso::Shape::kFree));
  button("Box", Action::kBox, is(Lasso::Shape::kBox));

  const engine::Grid& grid = touch.field().grid();
  const double cell = std::max(grid.spacingXMm(), grid.spacingYMm());
  const double samples = brushRadius(touch);
  beginFields();
  auto radius = static_cast<float>(samples);
  if (field("radius", [&] {
        return ImGui::SliderFloat("##radius", &radius, 0.0F, static_cast<float>(haptic::kMaxBrushRadius),
                                  "%.0f samples", ImGuiSliderFlags_AlwaysClamp);
      }))
    setBrushRadius(touch, std::round(static_cast<double>(radius)), context.notices);
  double radius_mm = samples * cell;
  if (field("", [&] {
        return typeNumber("##radius_mm", radius_mm, 0.0, haptic::kMaxBrushRadius * cell, "%.4g mm");
      }))
    setBrushRadius(touch, radius_mm / cell, context.notices);
  if (touch.mouse() != nullptr) {
    auto depth = static_cast<float>(touch.mouse()->pressMm() / cell);
    if (field("depth", [&] {
          return ImGui::SliderFloat("##depth", &depth, 0.0F, 4.0F, "%.2f cells",
                                    ImGuiSliderFlags_AlwaysClamp);
        }))
      setPressDepth(touch, static_cast<double>(depth) * cell);
  }
  haptic::Scene scene = touch.scene();
  bool limited = scene.max_change.has_value();
  (void)field("keep within", [&] {
    if (ImGui::Checkbox("##within", &limited)) context.act(Action::kKeepWithin);
    tip(Action::kKeepWithin);
    if (!scene.max_change) return false;
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1.0F);
    if (typeNumber("##most", *scene.max_change, 0.0, 1e9, "%.4g " + grid.height_unit.name))
      applyScene(touch, scene, context.notices);
    return false;
  });
  endFields();
  bool marks = display.marks, inverted = touch.scene().invert;
  if (ImGui::Checkbox("marks", &marks)) context.act(Action::kShowMarks);
  tip(Action::kShowMarks);
  besideOrBelow("upside down", Beside::kTick);
  if (ImGui::Checkbox("upside down", &inverted)) context.act(Action::kInvert);
  tip(Action::kInvert);
  if (ImGui::Button("Clear marks")) context.act(Action::kClearMarks);
  tip(Action::kClearMarks);
  besideOrBelow("Invert marks");
  if (ImGui::Button("Invert marks")) context.act(Action::kInvertMarks);
  tip(Action::kInvertMarks);
  if (marking.edit.busy()) {
    besideOrBelow("marking ...");
    ImGui::ProgressBar(static_cast<float>(marking.edit.progress()), ImVec2(-1.0F, 0.0F), "marking");
  }
}

}  // namespace fettle::app
