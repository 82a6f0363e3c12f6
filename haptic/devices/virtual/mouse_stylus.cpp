#include "haptic/devices/virtual/mouse_stylus.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "haptic/devices/hid/report_link.h"

namespace fettle::haptic {

namespace {

// Wishes that wait: a thousand cursor places a second for eight seconds in which the loop does not run.
constexpr std::size_t kWishes = 8192;
// Of them kept for buttons: places of the cursor between two others can be done without.
constexpr std::size_t kButtonPlaces = 64;
// A bunch of places from one frame of the window is followed over this many ticks.
constexpr std::size_t kSpreadTicks = 8;
// Arrived: this part of the way's scale is left.
constexpr double kArrived = 0.05;

constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();

}  // namespace

MouseStylus::MouseStylus(const MouseFeel& feel) : feel_(feel), wishes_(kWishes) {
  profile_.name = "mouse";
  profile_.space = DeviceSpace::kField;
  profile_.workspace_radius_mm = 1e9;  // the field is its workspace
  profile_.max_force_n = 0.0;
  profile_.gives_force = false;
  wish_.press_mm = std::clamp(feel.press_mm, 0.0, feel.deepest_mm);
}

void MouseStylus::tell() noexcept {
  // A ring without a place for a button is one of a loop that has stopped: nothing to make up for.
  said_ += wishes_.push(Wish(wish_)) ? 1 : 0;
}

void MouseStylus::setCursor(const glm::dvec3& p) noexcept {
  if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
    leave();
    return;
  }
  if (wish_.over && wish_.surface_mm == p) return;
  wish_.surface_mm = p;
  wish_.over = true;
  if (wishes_.freePlaces() > kButtonPlaces) tell();
}

void MouseStylus::leave() noexcept {
  if (!wish_.over) return;
  wish_.over = false;
  tell();
}

void MouseStylus::press(Tool tool) noexcept {
  wish_.held = true;
  wish_.tool = tool;
  tell();
}

void MouseStylus::release() noexcept {
  if (!wish_.held) return;
  wish_.held = false;
  tell();
}

void MouseStylus::wheel(double steps) noexcept {
  if (!std::isfinite(steps)) return;
  wish_.press_mm = std::clamp(wish_.press_mm - steps * feel_.wheel_step_mm, 0.0, feel_.deepest_mm);
  if (wishes_.freePlaces() > kButtonPlaces) tell();
}

DeviceInput MouseStylus::read() noexcept {
  return readAt(steadyNs());
}

bool MouseStylus::accept(const Wish& wish) noexcept {
  switch (stage_) {
    case Stage::kHover:
      now_ = wish;
      if (wish.held && wish.over) stage_ = Stage::kLifted;
      return true;
    case Stage::kLifted:
    case Stage::kLanding:
    case Stage::kEnding:
      return false;
    case Stage::kStroke:
      if (!wish.held) {
        now_.held = false;
        stage_ = Stage::kEnding;
        return true;
      }
      now_ = {wish.surface_mm, wish.press_mm, now_.tool, wish.over, true};
      return true;
  }
  return true;
}

void MouseStylus::takeWishes() noexcept {
  const std::size_t waiting = wishes_.waiting() + (has_next_ ? 1 : 0);
  // Where it hovers, the way there is nobody's stroke; but a press ends the taking in any case.
  for (std::size_t most = stage_ == Stage::kStroke ? 1 + waiting / kSpreadTicks : waiting; most > 0; --most) {
    if (!has_next_ && !wishes_.pop(next_)) return;
    has_next_ = !accept(next_);
    if (has_next_) return;
    ++accepted_;
  }
}

void MouseStylus::move(double passed_s) noexcept {
  if (stage_ == Stage::kLifted) {
    input_.position_mm = glm::dvec3(kNowhere);
    input_.buttons = 0;
    input_.tool.reset();
    tip_mm_ = now_.surface_mm + glm::dvec3{0.0, 0.0, feel_.hover_mm};
    stage_ = Stage::kLanding;
    return;
  }
  const bool stroke = stage_ != Stage::kHover;
  const glm::dvec3 target =
      now_.surface_mm + glm::dvec3{0.0, 0.0, stroke && now_.over ? -now_.press_mm : feel_.hover_mm};
  const bool smooth = stage_ == Stage::kHover || stage_ == Stage::kStroke;
  // First-order follow, exact for any step: stable however late the loop is.
  tip_mm_ += (target - tip_mm_) * -std::expm1(-passed_s / (smooth ? feel_.follow_s : feel_.land_s));
  input_.position_mm = tip_mm_;
  input_.buttons = stroke ? kPrimaryButton : 0;
  input_.tool = stroke ? std::optional(now_.tool) : std::nullopt;

  const glm::dvec3 left = target - tip_mm_;
  if (stage_ == Stage::kLanding && std::abs(left.z) < kArrived * (feel_.hover_mm + now_.press_mm))
    stage_ = Stage::kStroke;
  else if (stage_ == Stage::kEnding && (!now_.over || std::hypot(left.x, left.y) < kArrived * feel_.hover_mm))
    stage_ = Stage::kHover;
}

DeviceInput MouseStylus::readAt(std::int64_t now_ns) noexcept {
  const double passed_s =
      last_read_ns_ == 0 ? 0.0 : std::max(1e-9 * static_cast<double>(now_ns - last_read_ns_), 0.0);
  last_read_ns_ = now_ns;
  takeWishes();
  if (stage_ == Stage::kHover) followed_.store(accepted_, std::memory_order_release);
  if (!now_.over && !placed_) return input_;  // never was over the field: not there yet
  if (!placed_) {
    // Comes down from the hover height, wherever it first appears.
    tip_mm_ = now_.surface_mm + glm::dvec3{0.0, 0.0, feel_.hover_mm};
    placed_ = true;
  }
  move(passed_s);
  input_.link = LinkState::kConnected;
  input_.arrival_ns = now_ns;
  ++input_.sequence;
  return input_;
}

}  // namespace fettle::haptic
