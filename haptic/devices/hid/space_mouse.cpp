#include "haptic/devices/hid/space_mouse.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

#include "engine/base/stopwatch.h"

namespace fettle::haptic {

namespace {

// After a delay of the loop the tip must not jump: the time missed is not integrated.
constexpr double kLongestStep = 0.010;  // [s]

DeviceProfile spaceMouseProfile(const RateControl& control) {
  DeviceProfile p;
  p.name = "SpaceMouse";
  p.workspace_radius_mm = control.radius_mm;
  p.max_force_n = 0.0;
  p.gives_force = false;
  p.rate_hz = 1000.0;  // each read() is an input
  return p;
}

}  // namespace

double rateOf(std::int16_t deflection, const RateControl& control) noexcept {
  const double d = std::min(std::abs(deflection) / static_cast<double>(kSpaceMouseFull), 1.0);
  if (d <= control.dead_zone) return 0.0;
  const double rate = std::pow((d - control.dead_zone) / (1.0 - control.dead_zone), control.exponent);
  return deflection < 0 ? -rate : rate;
}

SpaceMouse::SpaceMouse(std::unique_ptr<ReportSource> source, const RateControl& control)
    : control_(control), profile_(spaceMouseProfile(control)), link_(std::move(source), *this) {
  assert(control.dead_zone >= 0.0 && control.dead_zone <= 0.9 && control.exponent >= 1.0);
}

SpaceMouse::~SpaceMouse() {
  link_.stop();
}

DeviceInput SpaceMouse::read() noexcept {
  return readAt(engine::steadyNs());
}

DeviceInput SpaceMouse::readAt(std::int64_t now_ns) noexcept {
  cap_.take();
  const Cap& cap = cap_.latest();
  const double step = last_read_ns_ == 0
                          ? 0.0
                          : std::clamp(1e-9 * static_cast<double>(now_ns - last_read_ns_), 0.0, kLongestStep);
  last_read_ns_ = now_ns;
  input_.link = cap.link;
  turn_ = glm::dvec3{0.0};
  if (cap.link != LinkState::kConnected) {
    input_.buttons = 0;
    return input_;
  }
  const bool held = 1e-9 * static_cast<double>(now_ns - cap.arrival_ns) < control_.hold_s;
  const auto rate = [&](std::size_t axis) { return held ? rateOf(cap.state.axes[axis], control_) : 0.0; };
  // The mouse's own axes are x right, y towards the user, z down: half a turn about x from the desk's.
  const glm::dvec3 speed = control_.full_speed_mm_s * glm::dvec3{rate(0), -rate(1), -rate(2)};
  turn_ = control_.full_turn_rad_s * glm::dvec3{rate(3), -rate(4), -rate(5)};
  input_.position_mm += step * speed;
  const double distance = glm::length(input_.position_mm);
  if (distance > control_.radius_mm) input_.position_mm *= control_.radius_mm / distance;
  input_.buttons = cap.state.buttons;
  input_.arrival_ns = now_ns;
  ++input_.sequence;
  return input_;
}

Pacing SpaceMouse::onOpen(std::size_t) noexcept {
  newest_ = {};
  newest_.link = LinkState::kConnected;
  cap_.publish(newest_);
  return Pacing::kNone;
}

bool SpaceMouse::onReport(std::span<const std::uint8_t> report, std::int64_t arrival_ns) noexcept {
  if (!takeSpaceMouse(report, newest_.state)) return false;
  newest_.arrival_ns = arrival_ns;
  return true;
}

Pacing SpaceMouse::onCaughtUp(std::uint64_t) noexcept {
  cap_.publish(newest_);
  return Pacing::kNone;
}

void SpaceMouse::onLost() noexcept {
  newest_ = {};
  cap_.publish(newest_);
}

}  // namespace fettle::haptic
