#include "app/work/device_check.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "app/texts/texts.h"

namespace fettle::app {
namespace {

// An axis answers when it moved so many times as far as each other one: a hand does not push along a ruler.
constexpr double kClearly = 2.0;

void include(DeviceReach& box, const glm::dvec3& position_mm) {
  box.low_mm = glm::min(box.low_mm, position_mm);
  box.high_mm = glm::max(box.high_mm, position_mm);
}

}  // namespace

void DeviceCheck::beginReach() {
  reach_.reset();
  first_.reset();
  running_ = Running::kReach;
}

void DeviceCheck::beginRest() {
  rest_.reset();
  first_.reset();
  resting_ = {};
  running_ = Running::kRest;
}

void DeviceCheck::beginDirection(PushedWay way) {
  directions_[static_cast<std::size_t>(way)].reset();
  first_.reset();
  asked_ = way;
  running_ = Running::kDirection;
}

void DeviceCheck::note(const haptic::LoopState& state) {
  if (running_ == Running::kNothing || state.link != haptic::LinkState::kConnected || state.tick == 0) return;
  now_ns_ = state.time_ns;
  if (!first_) {
    first_ = state;
    held_ = {state.device_mm, state.device_mm};
    if (running_ == Running::kReach) reach_ = held_;
  }
  if (running_ == Running::kReach) include(*reach_, state.device_mm);
  if (running_ == Running::kRest) noteRest(state);
  if (running_ == Running::kDirection) noteDirection(state);
}

void DeviceCheck::noteRest(const haptic::LoopState& state) {
  include(held_, state.device_mm);
  const glm::dvec3 moved = held_.extent();
  resting_.force_n = std::max(resting_.force_n, glm::length(state.given_n));
  resting_.moved_mm = std::max({moved.x, moved.y, moved.z});
  resting_.device_faults = state.safety_counters.faults - first_->safety_counters.faults;
  if (state.time_ns - first_->time_ns < kRest_ns) return;
  rest_ = resting_;
  running_ = Running::kNothing;
}

void DeviceCheck::noteDirection(const haptic::LoopState& state) {
  const glm::dvec3 moved = state.device_mm - first_->device_mm;
  const glm::dvec3 far = glm::abs(moved);
  const int axis = far.x >= far.y && far.x >= far.z ? 0 : far.y >= far.z ? 1 : 2;
  const double others = std::max(far[(axis + 1) % 3], far[(axis + 2) % 3]);
  if (far[axis] < kPush_mm || far[axis] < kClearly * others) return;
  directions_[static_cast<std::size_t>(asked_)] = Direction{axis, moved[axis] > 0.0 ? 1 : -1, far[axis]};
  running_ = Running::kNothing;
}

double DeviceCheck::restDone() const noexcept {
  if (running_ != Running::kRest || !first_) return 0.0;
  return std::clamp(static_cast<double>(now_ns_ - first_->time_ns) / static_cast<double>(kRest_ns), 0.0, 1.0);
}

bool DeviceCheck::reachIsUsable() const noexcept {
  return reach_ && 2.0 * reach_->radius() >= kLeastReach_mm;
}

const char* name(PushedWay way) noexcept {
  constexpr std::array kNames{textOf("right"), textOf("away"), textOf("up")};
  return kNames[static_cast<std::size_t>(way)];
}

std::string axisText(const DeviceCheck::Direction& direction) {
  return std::string(direction.sign > 0 ? "+" : "-") + "xyz"[direction.axis];
}

}  // namespace fettle::app
