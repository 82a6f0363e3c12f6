#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <imgui.h>

#include "app/window/panels/widgets.h"
#include "app/window/workstation.h"

namespace fettle::app {
namespace {

using haptic::Tool;

}  // namespace

void Workstation::toolPanel() {
  // As many buttons in a line as there is room for.
  bool first = true;
  const auto button = [&](const char* name, Action action, bool on) {
    if (!first) besideOrBelow(name);
    first = false;
    if (on) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
    if (ImGui::Button(name)) act(action);
    if (on) ImGui::PopStyleColor();
    tip(action);
  };
  const Tool tool = touch_->tool();
  const bool lasso = lasso_.active();
  button("View", Action::kNavigate, !tool_on_ && !lasso);
  button("Feel", Action::kFeel, tool_on_ && tool == Tool::kFeel);
  button("Smooth", Action::kSmooth, tool_on_ && tool == Tool::kSmooth);
  button("Mark", Action::kMark, tool_on_ && tool == Tool::kMark);
  button("Unmark", Action::kUnmark, tool_on_ && tool == Tool::kUnmark);
  button("Lasso", Action::kLasso, lasso && lasso_.shape() == Lasso::Shape::kFree);
  button("Box", Action::kBox, lasso && lasso_.shape() == Lasso::Shape::kBox);

  const engine::Grid& grid = touch_->field().grid();
  const double cell = std::max(grid.spacingXMm(), grid.spacingYMm());
  const bool marking = tool == Tool::kMark || tool == Tool::kUnmark;
  const double samples = marking ? touch_->scene().mark_radius_samples : touch_->scene().brush_radius_samples;
  beginFields();
  auto radius = static_cast<float>(samples);
  if (field("radius", [&] {
        return ImGui::SliderFloat("##radius", &radius, 0.0F, static_cast<float>(haptic::kMaxBrushRadius),
                                  "%.0f samples", ImGuiSliderFlags_AlwaysClamp);
      }))
    setBrushRadius(std::round(static_cast<double>(radius)));
  double radius_mm = samples * cell;
  if (field("", [&] {
        return typeNumber("##radius_mm", radius_mm, 0.0, haptic::kMaxBrushRadius * cell, "%.4g mm");
      }))
    setBrushRadius(radius_mm / cell);
  if (touch_->mouse() != nullptr) {
    auto depth = static_cast<float>(touch_->mouse()->pressMm() / cell);
    if (field("depth", [&] {
          return ImGui::SliderFloat("##depth", &depth, 0.0F, 4.0F, "%.2f cells",
                                    ImGuiSliderFlags_AlwaysClamp);
        }))
      setPressDepth(static_cast<double>(depth) * cell);
  }
  haptic::Scene scene = touch_->scene();
  bool limited = scene.max_change.has_value();
  (void)field("keep within", [&] {
    if (ImGui::Checkbox("##within", &limited)) act(Action::kKeepWithin);
    tip(Action::kKeepWithin);
    if (!scene.max_change) return false;
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1.0F);
    if (typeNumber("##most", *scene.max_change, 0.0, 1e9, "%.4g " + grid.height_unit.name)) takeScene(scene);
    return false;
  });
  endFields();
  bool marks = display_.marks, inverted = touch_->scene().invert;
  if (ImGui::Checkbox("marks", &marks)) act(Action::kShowMarks);
  tip(Action::kShowMarks);
  besideOrBelow("upside down", Beside::kTick);
  if (ImGui::Checkbox("upside down", &inverted)) act(Action::kInvert);
  tip(Action::kInvert);
  if (ImGui::Button("Clear marks")) act(Action::kClearMarks);
  tip(Action::kClearMarks);
  besideOrBelow("Invert marks");
  if (ImGui::Button("Invert marks")) act(Action::kInvertMarks);
  tip(Action::kInvertMarks);
  if (mark_edit_.busy()) {
    besideOrBelow("marking ...");
    ImGui::ProgressBar(static_cast<float>(mark_edit_.progress()), ImVec2(-1.0F, 0.0F), "marking");
  }
}

}  // namespace fettle::app
