// The page of the device: what it does, measured by hand without force, and how it is used from now on.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <imgui.h>

#include "app/texts/texts.h"
#include "app/window/panels/dialog_button.h"
#include "app/window/panels/panels.h"
#include "app/work/device_check.h"

namespace fettle::app {
namespace {

using Choice = Answer::Choice;
using render::Key;
using render::letter;
using render::PanelColour;
using Running = DeviceCheck::Running;

constexpr float kDevicePage = 560.0F;     // at scale 1 [pixels]
constexpr double kShownReach_mm = 150.0;  // either side of the middle, at least
constexpr double kStill_mm = 2.0;         // of a stylus that lies or is held still
constexpr double kMotionStep = 0.1;

constexpr std::array<const char*, 3> kReachAxes{textOf("x, right"), textOf("y, away"), textOf("z, up")};

// What holds the clutch and what opens the tools around the tip, in the order in which the page offers it.
struct ButtonOffer {
  std::uint32_t buttons;
  const char* name;
};
constexpr std::array kOffers{
    ButtonOffer{haptic::kSecondaryButton, textOf("second button")},
    ButtonOffer{1U << 2U, textOf("third button")},
    ButtonOffer{1U << 3U, textOf("fourth button")},
    ButtonOffer{0, textOf("none")},
};

void showLine(const std::string& line) {
  ImGui::TextUnformatted(line.c_str());
}

PanelColour outcome(bool as_expected) {
  return as_expected ? PanelColour::kGood : PanelColour::kProblem;
}

std::size_t offerOf(std::uint32_t buttons) {
  const auto it = std::ranges::find(kOffers, buttons, &ButtonOffer::buttons);
  return it == kOffers.end() ? 0 : static_cast<std::size_t>(it - kOffers.begin());
}

// One axis: the measured part, and where the stylus is now.
void reachBar(int axis, const std::optional<DeviceReach>& reach, double now_mm, double shown_mm) {
  const float line = ImGui::GetTextLineHeight();
  ImGui::TextUnformatted(tr(kReachAxes[static_cast<std::size_t>(axis)]));
  ImGui::SameLine(6.0F * line);
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const float width = 14.0F * line;
  ImGui::Dummy(ImVec2(width, line));
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const auto at = [&](double mm) {
    return corner.x + width * static_cast<float>(std::clamp(0.5 + 0.5 * mm / shown_mm, 0.0, 1.0));
  };
  list.AddRectFilled(corner, ImVec2(corner.x + width, corner.y + line), colourOf(PanelColour::kField), 3.0F);
  if (reach)
    list.AddRectFilled(ImVec2(at(reach->low_mm[axis]), corner.y),
                       ImVec2(at(reach->high_mm[axis]), corner.y + line), colourOf(PanelColour::kProgress),
                       3.0F);
  list.AddRectFilled(ImVec2(at(now_mm) - 1.5F, corner.y), ImVec2(at(now_mm) + 1.5F, corner.y + line),
                     colourOf(PanelColour::kText));
  ImGui::SameLine();
  if (reach)
    showLine(trFormat("{:.1f} to {:.1f} mm, now {:.1f}", reach->low_mm[axis], reach->high_mm[axis], now_mm));
  else
    showLine(trFormat("now {:.1f} mm", now_mm));
}

void reachPart(Parts& parts, const haptic::LoopState& now) {
  DeviceCheck& check = parts.device_check;
  DeviceSetup& setup = parts.device_setup;
  Questions& questions = parts.feedback.questions;
  const bool runs = check.running() == Running::kReach;
  ImGui::TextDisabled("%s", tr("Reach"));
  const std::optional<DeviceReach>& shown = check.reach() ? check.reach() : setup.reach;
  double shown_mm = kShownReach_mm;
  if (shown)
    for (int axis = 0; axis < 3; ++axis)
      shown_mm = std::max({shown_mm, std::abs(shown->low_mm[axis]), std::abs(shown->high_mm[axis])});
  for (int axis = 0; axis < 3; ++axis) reachBar(axis, shown, now.device_mm[axis], shown_mm);
  if (dialogButton(runs ? textOf("Use what was reached (R)") : textOf("Measure the reach (R)"), questions,
                   letter('R'))) {
    if (!runs) {
      check.beginReach();
    } else if (check.reachIsUsable()) {
      check.stop();
      setup.reach = check.reach();
    }
  }
  ImGui::SameLine();
  ImGui::BeginDisabled(!setup.reach);
  if (dialogButton("The maker's (M)", questions, letter('M'))) setup.reach.reset();
  ImGui::EndDisabled();
  if (runs)
    ImGui::TextUnformatted(check.reachIsUsable()
                               ? tr("move the stylus slowly to all its limits, then press R")
                               : tr("move the stylus slowly to all its limits: not far enough yet"));
  else if (setup.reach)
    showLine(trFormat("used: a ball of {:.0f} mm about its middle", setup.reach->radius()));
  else
    ImGui::TextUnformatted(tr("used: what its maker states"));
}

void restPart(Parts& parts) {
  DeviceCheck& check = parts.device_check;
  ImGui::TextDisabled("%s", tr("Force at rest"));
  if (dialogButton("Measure at rest (T)", parts.feedback.questions, letter('T'))) check.beginRest();
  ImGui::SameLine();
  if (check.running() == Running::kRest) {
    ImGui::ProgressBar(static_cast<float>(check.restDone()), ImVec2(-1.0F, 0.0F),
                       tr("let it lie, or hold it still"));
  } else if (check.rest()) {
    const DeviceCheck::Rest& rest = *check.rest();
    const bool good = rest.force_n == 0.0 && rest.device_faults == 0 && rest.moved_mm <= kStill_mm;
    textIn(outcome(good), trFormat("{:.3f} N sent, moved {:.2f} mm, {} faults", rest.force_n, rest.moved_mm,
                                   rest.device_faults));
    if (rest.moved_mm > kStill_mm)
      ImGui::TextUnformatted(
          tr("it moved: by the hand, by its own weight, or by a force that is not Fettle's"));
  } else {
    ImGui::TextUnformatted(tr("no force is sent; a stylus at rest stays where it is"));
  }
}

void directionPart(Parts& parts) {
  DeviceCheck& check = parts.device_check;
  ImGui::TextDisabled("%s", tr("Directions"));
  for (int i = 0; i < kPushedWays; ++i) {
    const auto way = static_cast<PushedWay>(i);
    const std::string label = trFormat("Push {} ({})", tr(name(way)), i + 1);
    if (dialogButton(label.c_str(), parts.feedback.questions, letter(static_cast<char>('1' + i))))
      check.beginDirection(way);
    ImGui::SameLine(11.0F * ImGui::GetTextLineHeight());
    if (check.running() == Running::kDirection && check.asked() == way) {
      showLine(trFormat("push the stylus straight {}", tr(name(way))));
    } else if (const auto& came = check.direction(way)) {
      const bool right = DeviceCheck::asExpected(way, *came);
      textIn(outcome(right), trFormat("{} came, {:.0f} mm{}", axisText(*came), came->moved_mm,
                                      right ? "" : tr(": turn the device, or see its configuration")));
    } else {
      ImGui::TextDisabled("%s", trFormat("+{} is expected", "xyz"[i]).c_str());
    }
  }
}

void motionPart(Parts& parts) {
  DeviceSetup& setup = parts.device_setup;
  Questions& questions = parts.feedback.questions;
  ImGui::TextDisabled("%s", tr("Motion"));
  const auto move = [&](double step) {
    setup.motion = std::clamp(std::round((setup.motion + step) / kMotionStep) * kMotionStep,
                              DeviceSetup::kLeastMotion, 1.0);
  };
  if (dialogButton("Finer (-)", questions, Key::kMinus)) move(-kMotionStep);
  ImGui::SameLine();
  if (dialogButton("Wider (+)", questions, Key::kPlus)) move(kMotionStep);
  ImGui::SameLine();
  showLine(trFormat("{:.0f} % of what reaches all of the scan", 100.0 * setup.motion));
  const auto after = [](std::uint32_t buttons) {
    return kOffers[(offerOf(buttons) + 1) % kOffers.size()].buttons;
  };
  if (dialogButton("Clutch (C)", questions, letter('C'))) setup.giveClutch(after(setup.clutch_buttons));
  ImGui::SameLine();
  showLine(trFormat("held by: {}", tr(kOffers[offerOf(setup.clutch_buttons)].name)));
  if (dialogButton("Tools around the tip (U)", questions, letter('U')))
    setup.giveMenu(after(setup.menu_buttons));
  explain(
      "While the button is held, a movement of the stylus points at a tool or a tip; letting go chooses it.");
  ImGui::SameLine();
  showLine(trFormat("opened by: {}", tr(kOffers[offerOf(setup.menu_buttons)].name)));
}

}  // namespace

std::optional<Choice> devicePage(Parts& parts) {
  LoopClient& client = *parts.document.client();
  Questions& questions = parts.feedback.questions;
  const haptic::DeviceProfile& profile = client.device().profile();
  const haptic::LoopState now = client.state();
  ImGui::Dummy(ImVec2(kDevicePage * static_cast<float>(parts.window.scale()), 0.0F));
  showLine(profile.serial.empty() ? std::string(tr(std::string_view(profile.name)))
                                  : trFormat("{}, serial number {}", profile.name, profile.serial));
  const bool measures = profile.space == haptic::DeviceSpace::kDesk;
  if (!measures)
    ImGui::TextUnformatted(tr("It moves in the picture itself: there is nothing to measure."));
  else if (now.link != haptic::LinkState::kConnected)
    textIn(PanelColour::kProblem, now.link == haptic::LinkState::kUncalibrated
                                      ? tr("It is not calibrated: go back, and calibrate it (Ctrl+Shift+A).")
                                      : tr("It is not plugged in."));
  else
    ImGui::TextUnformatted(tr("No force is given while this page is open, and none until A is pressed."));
  if (measures) {
    ImGui::Separator();
    reachPart(parts, now);
    ImGui::Separator();
    restPart(parts);
    ImGui::Separator();
    directionPart(parts);
    ImGui::Separator();
    motionPart(parts);
    ImGui::Separator();
    // What was begun in this frame begins where the stylus is now.
    parts.device_check.note(now);
  }
  ImGui::BeginDisabled(!measures);
  const bool saves = dialogButton("Save (Enter)", questions, Key::kEnter) && measures;
  ImGui::EndDisabled();
  ImGui::SameLine();
  const bool leaves = dialogButton("Go back (Esc)", questions, Key::kEscape);
  if (saves) return Choice::kConfirm;
  return leaves ? std::optional(Choice::kBack) : std::nullopt;
}

}  // namespace fettle::app
