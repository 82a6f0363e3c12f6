#include "app/view/workstation.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <imgui.h>

#include "app/view/panels/widgets.h"

namespace fettle::app {
namespace {

using haptic::Tool;

}  // namespace

void Workstation::toolPanel() {
  const auto button = [&](const char* name, Action action, bool on) {
    if (on) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
    if (ImGui::Button(name)) act(action);
    if (on) ImGui::PopStyleColor();
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip("%s", keyText(shortcutOf(action).key, shortcutOf(action).modifiers).c_str());
    ImGui::SameLine();
  };
  const Tool tool = touch_->tool();
  button("View", Action::kNavigate, !tool_on_);
  button("Feel", Action::kFeel, tool_on_ && tool == Tool::kFeel);
  button("Smooth", Action::kSmooth, tool_on_ && tool == Tool::kSmooth);
  button("Mark", Action::kMark, tool_on_ && tool == Tool::kMark);
  button("Unmark", Action::kUnmark, tool_on_ && tool == Tool::kUnmark);
  ImGui::NewLine();
  const bool marking = tool == Tool::kMark || tool == Tool::kUnmark;
  auto radius = static_cast<float>(marking ? touch_->scene().mark_radius_samples
                                           : touch_->scene().brush_radius_samples);
  if (ImGui::SliderFloat("radius", &radius, 0.0F, 64.0F, "%.0f samples")) setBrushRadius(std::round(radius));
  if (touch_->mouse() != nullptr) {
    const engine::Grid& grid = touch_->field().grid();
    const double cell = std::max(grid.spacingXMm(), grid.spacingYMm());
    auto depth = static_cast<float>(touch_->mouse()->pressMm() / cell);
    if (ImGui::SliderFloat("depth", &depth, 0.0F, 4.0F, "%.2f cells")) setPressDepth(depth * cell);
  }
  bool limited = touch_->scene().max_change.has_value();
  haptic::Scene scene = touch_->scene();
  if (ImGui::Checkbox("keep within", &limited)) {
    scene.max_change = limited ? std::optional<double>(0.05) : std::nullopt;
    touch_->setScene(scene);
  }
  if (limited && scene.max_change) {
    ImGui::SameLine();
    double most = *scene.max_change;
    const std::string unit = "%.4g " + touch_->field().grid().height_unit.name;
    if (ImGui::InputDouble("##most", &most, 0.0, 0.0, unit.c_str(), ImGuiInputTextFlags_EnterReturnsTrue) &&
        most >= 0.0) {
      scene.max_change = most;
      touch_->setScene(scene);
    }
  }
  bool marks = display_.marks, inverted = touch_->scene().invert;
  if (ImGui::Checkbox("marks", &marks)) act(Action::kShowMarks);
  ImGui::SameLine();
  if (ImGui::Checkbox("upside down", &inverted)) act(Action::kInvert);
  ImGui::SameLine();
  if (ImGui::SmallButton("Clear marks")) act(Action::kClearMarks);
}

}  // namespace fettle::app
