#include <fmt/format.h>
#include <imgui.h>

#include "app/window/panels/widgets.h"
#include "app/window/workstation.h"

namespace fettle::app {

void Workstation::edgePanel() {
  using engine::EdgeResponse;
  beginFields();
  auto sigma = static_cast<float>(edges_.sigma);
  if (field("scale", [&] {
        return ImGui::SliderFloat("##scale", &sigma, static_cast<float>(EdgeResponse::kSmallestSigma),
                                  static_cast<float>(EdgeResponse::kLargestSigma), "%.2f samples",
                                  ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_Logarithmic);
      }))
    edges_.sigma = static_cast<double>(sigma);
  const bool scale_done = ImGui::IsItemDeactivatedAfterEdit();
  auto sensitivity = static_cast<float>(edges_.choice.sensitivity);
  if (field("sensitivity", [&] {
        return ImGui::SliderFloat("##sensitivity", &sensitivity, 0.0F, 1.0F, "%.2f",
                                  ImGuiSliderFlags_AlwaysClamp);
      })) {
    edges_.choice.sensitivity = static_cast<double>(sensitivity);
    edges_.redraw(*touch_);
  }
  auto thickness = static_cast<float>(edges_.choice.thickness);
  if (field("thickness", [&] {
        return ImGui::SliderFloat("##thickness", &thickness, 0.0F, 16.0F, "%.1f samples",
                                  ImGuiSliderFlags_AlwaysClamp);
      })) {
    edges_.choice.thickness = static_cast<double>(thickness);
    edges_.redraw(*touch_);
  }
  endFields();
  if (edges_.on() && scale_done) edges_.search(*touch_);
  if (edges_.busy() && edges_.suggestion() == nullptr) {
    ImGui::ProgressBar(static_cast<float>(edges_.progress()), ImVec2(-ImGui::GetFontSize() * 5.0F, 0.0F),
                       "looking");
    ImGui::SameLine();
    if (ImGui::Button("Cancel")) edges_.drop();
    return;
  }
  if (!edges_.on()) {
    if (ImGui::Button("Suggest edges")) act(Action::kEdges);
    tip(Action::kEdges);
    return;
  }
  const engine::EdgeSuggestion& found = *edges_.suggestion();
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextUnformatted(
      fmt::format("{} lines, {} samples, not marked yet", found.lines, found.samples).c_str());
  ImGui::PopTextWrapPos();
  if (ImGui::Button("Take")) act(Action::kFilterApply);
  tip(Action::kFilterApply);
  ImGui::SameLine();
  if (ImGui::Button("Drop")) act(Action::kNavigate);
  tip(Action::kNavigate);
  besideOrBelow("or paint over it");
  ImGui::TextDisabled("or paint over it");
}

}  // namespace fettle::app
