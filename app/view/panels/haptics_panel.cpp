#include "app/view/workstation.h"

#include <array>
#include <cmath>

#include <fmt/format.h>
#include <imgui.h>

#include "app/view/panels/widgets.h"

namespace fettle::app {

void Workstation::hapticsPanel() {
  const haptic::LoopState state = touch_->state();
  const haptic::DeviceProfile& profile = touch_->device().profile();
  figure("device", profile.name + (profile.gives_force ? "" : ", no force"));
  figure("link", state.link == haptic::LinkState::kConnected      ? "connected"
                 : state.link == haptic::LinkState::kUncalibrated ? "not calibrated"
                                                                  : "not plugged in");
  figure("safety", std::string(haptic::name(state.safety)));
  if (ImGui::Button("Arm")) act(Action::kArm);
  ImGui::SameLine();
  if (ImGui::Button("Disarm")) act(Action::kDisarm);
  ImGui::SameLine();
  if (ImGui::Button("Calibrate")) act(Action::kCalibrate);
  if (!force_plot_.empty())
    ImGui::PlotLines("##force", force_plot_.data(), static_cast<int>(force_plot_.size()), 0, "force [N]",
                     0.0F, static_cast<float>(touch_->scene().force_limit_n), ImVec2(-1.0F, 60.0F));
  // Lateness in octaves: how many ticks came that late.
  std::array<float, 12> classes{};
  for (std::size_t i = 0; i < classes.size(); ++i) {
    const std::int64_t low = std::int64_t{1000} << i;
    const auto above = touch_->timing().lateness.countAbove(low);
    const auto far = touch_->timing().lateness.countAbove(2 * low);
    classes[i] = std::log10(1.0F + static_cast<float>(above - far));
  }
  ImGui::PlotHistogram("##late", classes.data(), static_cast<int>(classes.size()), 0,
                       "lateness 1 us .. 4 ms, by octaves, log count", 0.0F, 6.0F, ImVec2(-1.0F, 60.0F));
  const haptic::TimingFigures compute = touch_->timing().compute.figures();
  figure("a tick takes p50, p99",
         fmt::format("{:.1f}, {:.1f} us", microseconds(compute.p50_ns), microseconds(compute.p99_ns)));
  figure("stiffness", fmt::format("{:.3g} N/mm", touch_->scene().stiffness_n_per_mm));
  std::string effects;
  for (const haptic::EffectKind kind : touch_->scene().effects)
    effects += (effects.empty() ? "" : ", ") + std::string(haptic::effectName(kind));
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextDisabled("%s", effects.c_str());
  for (const std::string& missing : touch_->realTime().missing)
    ImGui::TextColored(ImVec4(1.0F, 0.75F, 0.3F, 1.0F), "%s", missing.c_str());
  ImGui::PopTextWrapPos();
}

}  // namespace fettle::app
