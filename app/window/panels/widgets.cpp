#include "app/window/panels/widgets.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/window/action_tips.h"

namespace fettle::app {

constexpr float kTip = 24.0F;    // of a tip's width, in heights of a letter
constexpr float kNames = 0.36F;  // of a panel's width, for the names of fields and figures

void figure(const char* name, const std::string& value) {
  const float left = ImGui::GetCursorPosX(), width = ImGui::GetContentRegionAvail().x;
  ImGui::TextDisabled("%s", name);
  const float column = left + kNames * width;
  ImGui::SameLine(std::max(column, left + ImGui::CalcTextSize(name).x + ImGui::GetStyle().ItemSpacing.x));
  const float room = ImGui::GetContentRegionAvail().x;
  if (ImGui::CalcTextSize(value.c_str()).x <= room) {
    ImGui::TextUnformatted(value.c_str());
    return;
  }
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextUnformatted(value.c_str());
  ImGui::PopTextWrapPos();
}

void workBar(const WorkProgress& progress, float width, const char* what) {
  const std::string text =
      progress.left ? fmt::format("{}, {} left", what, durationText(*progress.left)) : what;
  ImGui::ProgressBar(static_cast<float>(progress.share), ImVec2(width, 0.0F), text.c_str());
}

void explain(std::string_view says) {
  if (says.empty() || !ImGui::IsItemHovered()) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(kTip * ImGui::GetFontSize());
  ImGui::TextUnformatted(says.data(), says.data() + says.size());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

void tip(Action action) {
  const ActionRow& s = rowOf(action);
  const std::string_view says = tipOf(action);
  explain(fmt::format("{}: {}{}{}", s.name, keyText(s.key, s.modifiers), says.empty() ? "" : "\n", says));
}

void actionButton(const char* name, Action action, const Act& act) {
  if (ImGui::Button(name)) act(action);
  tip(action);
}

void actionTick(const char* name, bool ticked, Action action, const Act& act) {
  if (ImGui::Checkbox(name, &ticked)) act(action);
  tip(action);
}

void sameLineIfFits(const char* text, ItemKind what) {
  const ImGuiStyle& style = ImGui::GetStyle();
  const float needed = what == ItemKind::kButton ? style.FramePadding.x * 2.0F
                                                 : ImGui::GetFrameHeight() + style.ItemInnerSpacing.x;
  ImGui::SameLine();
  if (ImGui::GetContentRegionAvail().x < ImGui::CalcTextSize(text).x + needed) ImGui::NewLine();
}

void beginFields() {
  ImGui::PushItemWidth(-1.0F);
}

void endFields() {
  ImGui::PopItemWidth();
}

void fieldName(const char* name, std::string_view says) {
  const float left = ImGui::GetCursorPosX(), width = ImGui::GetContentRegionAvail().x;
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("%s", name);
  explain(says);
  const float room = kNames * width - ImGui::GetStyle().ItemInnerSpacing.x;
  if (ImGui::CalcTextSize(name).x <= room) ImGui::SameLine(left + kNames * width);
}

std::optional<double> typedNumber(const char* id, double value, const std::string& format) {
  double typed = value;
  if (!ImGui::InputDouble(id, &typed, 0.0, 0.0, format.c_str(),
                          ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll) ||
      !std::isfinite(typed) || typed == value)
    return std::nullopt;
  return typed;
}

bool typeNumber(const char* id, double& value, double low, double high, const std::string& format) {
  const auto typed = typedNumber(id, value, format);
  const double taken = std::clamp(typed.value_or(value), low, high);
  if (!typed || taken == value) return false;
  value = taken;
  return true;
}

bool typeLength(const char* id, double& value, double low, double high, const render::ShownUnit& unit) {
  const auto typed = typedNumber(id, value * unit.per_unit, "%.4g " + unit.name);
  const double taken = std::clamp(typed ? *typed / unit.per_unit : value, low, high);
  if (!typed || taken == value) return false;
  value = taken;
  return true;
}

std::string lengthText(double value, const render::ShownUnit& unit, int digits) {
  const double shown = value * unit.per_unit;
  // No exponents where a person reads a plain number sooner.
  const double size = std::abs(shown);
  if (!(size >= std::pow(10.0, digits) && size < 1e7))
    return fmt::format("{:.{}g} {}", shown, digits, unit.name);
  const double step = std::pow(10.0, std::floor(std::log10(size)) + 1.0 - digits);
  return fmt::format("{:.0f} {}", std::round(shown / step) * step, unit.name);
}

render::ShownUnit ofMillimetres(const render::ShownUnit& shown, double mm) {
  return {shown.name, shown.per_unit / mm};
}

std::string bytesText(double bytes) {
  if (bytes < 1e4) return fmt::format("{:.0f} B", bytes);
  if (bytes < 1e7) return fmt::format("{:.1f} kB", bytes * 1e-3);
  if (bytes < 1e10) return fmt::format("{:.1f} MB", bytes * 1e-6);
  return fmt::format("{:.1f} GB", bytes * 1e-9);
}

}  // namespace fettle::app
