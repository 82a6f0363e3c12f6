#include "haptic/safety/safety.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <glm/geometric.hpp>

#include "haptic/base/force.h"

namespace fettle::haptic {

namespace {

// Longest time that a step may use for a rise, however late the tick: two periods at 1 kHz.
constexpr double kLongestRise_s = 0.002;
// What a step with an impossible time counts for.
constexpr double kNominal_s = 0.001;
// Share of the allowed warmth above which the thermal limit falls.
constexpr double kThermalKnee = 0.8;

// From `from` towards `to` by at most `distance`. The norm stays within the larger of both: balls are convex.
glm::dvec3 approach(const glm::dvec3& from, const glm::dvec3& to, double distance, bool& held) noexcept {
  const glm::dvec3 change = to - from;
  const double size = glm::length(change);
  held = size > distance;
  return held ? from + change * (distance / size) : to;
}

}  // namespace

std::string_view name(SafetyState state) noexcept {
  switch (state) {
    case SafetyState::kDisconnected:
      return "disconnected";
    case SafetyState::kUncalibrated:
      return "uncalibrated";
    case SafetyState::kArmed:
      return "armed";
    case SafetyState::kRamping:
      return "ramping";
    case SafetyState::kActive:
      return "active";
    case SafetyState::kFault:
      return "fault";
  }
  return "";
}

std::string_view name(FaultCause cause) noexcept {
  switch (cause) {
    case FaultCause::kNone:
      return "";
    case FaultCause::kInputLost:
      return "input lost";
    case FaultCause::kLoopStopped:
      return "loop stopped";
    case FaultCause::kUnplugged:
      return "unplugged";
    case FaultCause::kOutputStalled:
      return "output stalled";
    case FaultCause::kLastResort:
      return "ended by a signal";
  }
  return "";
}

ForceGuard::ForceGuard(const SafetyLimits& limits) noexcept : limits_(limits) {
  assert(!limitsProblem(limits));
}

bool ForceGuard::armed() const noexcept {
  return state_ == SafetyState::kArmed || state_ == SafetyState::kRamping || state_ == SafetyState::kActive;
}

void ForceGuard::disarm() noexcept {
  arm_requested_ = false;
  if (armed()) state_ = SafetyState::kUncalibrated;
}

void ForceGuard::fault(FaultCause cause) noexcept {
  if (state_ == SafetyState::kFault) return;
  state_ = SafetyState::kFault;
  cause_ = cause;
  silent_ = false;
  ++counters_.faults;
}

void ForceGuard::startRamp(double from_n) noexcept {
  state_ = SafetyState::kRamping;
  ceiling_n_ = from_n;
}

void ForceGuard::advanceState(const SafetyInput& input, double dt_s, double age_s) noexcept {
  if (fault_requested_) fault(FaultCause::kLastResort);
  if (input.link != LinkState::kConnected && armed()) fault(FaultCause::kUnplugged);
  if (state_ != SafetyState::kFault && !armed())
    state_ = input.link == LinkState::kDisconnected ? SafetyState::kDisconnected : SafetyState::kUncalibrated;

  if (armed()) {
    if (dt_s >= limits_.fault_s)
      fault(FaultCause::kLoopStopped);
    else if (age_s >= limits_.fault_s)
      fault(FaultCause::kInputLost);
    else if (!(input.output_waits_s < limits_.fault_s))
      fault(FaultCause::kOutputStalled);
  }

  // A late tick counts as a silence too: the driver replaces a force that is not renewed for 10 ms by zero.
  const bool gap = age_s >= limits_.silence_s || dt_s >= limits_.silence_s;
  const bool responding = !gap && input.output_waits_s < limits_.fault_s;
  if (arm_requested_) {
    arm_requested_ = false;
    if (!armed()) {
      if (input.link == LinkState::kConnected && responding && !fault_requested_) {
        state_ = SafetyState::kArmed;
        cause_ = FaultCause::kNone;
        silent_ = false;
      } else {
        ++counters_.arms_refused;
      }
    }
  }
  if (!armed()) return;
  if (gap) {
    if (!silent_) ++counters_.silences;
    silent_ = true;
  } else if (silent_) {
    silent_ = false;
    if (state_ != SafetyState::kArmed) startRamp(glm::length(output_));
  }
}

void ForceGuard::rampUnexpectedRise(const SafetyInput& input, double dt_s) noexcept {
  const double command_n = glm::length(input.command_n);
  if (state_ == SafetyState::kArmed) {
    if (!silent_ && glm::length(input.command_n - input.at_rest_n) <= limits_.small_force_n) startRamp(0.0);
  } else if (state_ == SafetyState::kActive || state_ == SafetyState::kRamping) {
    const bool jumped = glm::length(input.velocity_mm_per_s) > limits_.jump_speed_mm_per_s;
    const bool disturbed = input.disturbance != Disturbance::kNone;
    counters_.jumps += jumped ? 1 : 0;
    counters_.disturbances += disturbed ? 1 : 0;
    const double at_once = glm::length(output_) + limits_.small_force_n;
    // Negated: a command whose length overflows is a rise as well.
    if ((jumped || disturbed) && !(command_n <= at_once)) {
      counters_.disturbances_ramped += disturbed ? 1 : 0;
      startRamp(state_ == SafetyState::kRamping ? std::min(ceiling_n_, at_once) : at_once);
    }
  }
  if (state_ != SafetyState::kRamping) return;
  ceiling_n_ += limits_.peak_force_n * std::min(dt_s, kLongestRise_s) / limits_.ramp_s;
  if (ceiling_n_ >= limits_.peak_force_n) state_ = SafetyState::kActive;
}

glm::dvec3 ForceGuard::limitSpeed(const glm::dvec3& force, const glm::dvec3& velocity) noexcept {
  const double speed = glm::length(velocity);
  // A jump of the pose is not a speed to be damped; its rise is ramped instead.
  if (!(speed > limits_.speed_limit_mm_per_s) || speed > limits_.jump_speed_mm_per_s) return force;
  ++counters_.over_speed;
  const glm::dvec3 along = velocity / speed;
  const double excess = speed - limits_.speed_limit_mm_per_s;
  const double driving = std::max(glm::dot(force, along), 0.0);
  const double brake = std::min(limits_.damping_n_s_per_mm * excess, limits_.peak_force_n);
  return force - along * (driving * std::min(excess / limits_.speed_limit_mm_per_s, 1.0) + brake);
}

double ForceGuard::motorFactor(const glm::dvec3& force) noexcept {
  if (limits_.motors.factor == nullptr) return 1.0;
  const double factor = limits_.motors.factor(limits_.motors.device, force);
  if (!(factor >= 0.0 && factor <= 1.0)) {
    ++counters_.bad_motor_scale;
    return 0.0;
  }
  counters_.motor_scaled += factor < 1.0 ? 1 : 0;
  return factor;
}

void ForceGuard::noteHeld(const SafetyInput& input, double dt_s) noexcept {
  if (!input.output_pending) {
    held_ = output_;
    held_for_s_ = 0.0;
  }
  held_for_s_ += dt_s;
}

// A force that falls to zero may do so whatever force the device holds; from the nearest such force it may
// differ by what the elapsed time allows. The set of these forces is convex and never shrinks while the
// device waits, so this moves the output no farther from the one before.
glm::dvec3 ForceGuard::limitRiseFromHeld(const glm::dvec3& force) noexcept {
  const double square = glm::dot(held_, held_);
  const double share = square > 0.0 ? std::clamp(glm::dot(force, held_) / square, 0.0, 1.0) : 0.0;
  const double step_n = 1000.0 * limits_.slew_n_per_ms * std::min(held_for_s_, kLongestRise_s);
  bool behind = false;
  const glm::dvec3 limited = approach(held_ * share, force, step_n, behind);
  counters_.behind += behind ? 1 : 0;
  return limited;
}

double ForceGuard::warmth() const noexcept {
  const double allowed = limits_.continuous_force_n * limits_.continuous_force_n;
  return allowed > 0.0 ? warmth_n2_ / allowed : (warmth_n2_ > 0.0 ? 1.0 : 0.0);
}

double ForceGuard::thermalLimit() const noexcept {
  const double past_knee = std::clamp((warmth() - kThermalKnee) / (1.0 - kThermalKnee), 0.0, 1.0);
  return limits_.peak_force_n - (limits_.peak_force_n - limits_.continuous_force_n) * past_knee;
}

glm::dvec3 ForceGuard::step(const SafetyInput& input) noexcept {
  ++counters_.ticks;
  const bool good_time = std::isfinite(input.dt_s) && input.dt_s > 0.0 && std::isfinite(input.input_age_s);
  const bool numbers = finite(input.command_n) && finite(input.velocity_mm_per_s);
  const double dt_s = good_time ? input.dt_s : kNominal_s;
  counters_.bad_time += good_time ? 0 : 1;
  counters_.not_finite += numbers ? 0 : 1;
  const bool good = good_time && numbers;
  bad_for_s_ = good ? 0.0 : bad_for_s_ + dt_s;

  // The device held the last force until now.
  warmth_n2_ += (glm::dot(output_, output_) - warmth_n2_) * -std::expm1(-dt_s / limits_.thermal_tau_s);

  advanceState(input, dt_s, std::max(good_time ? input.input_age_s : 0.0, bad_for_s_));
  if (good) rampUnexpectedRise(input, dt_s);
  if (input.link == LinkState::kDisconnected) return output_ = slewed_ = held_ = glm::dvec3(0.0);
  noteHeld(input, dt_s);

  const bool giving = (state_ == SafetyState::kRamping || state_ == SafetyState::kActive) && good && !silent_;
  const bool ramping = state_ == SafetyState::kRamping;
  const double limit_n = ramping ? std::min(ceiling_n_, limits_.peak_force_n) : limits_.peak_force_n;
  glm::dvec3 target(0.0);
  if (giving && limit_n > 0.0) {
    const ClampedForce clamped = clampForce(input.command_n, limit_n);
    target = clamped.force_n;
    if (clamped.clamped) ++(ramping ? counters_.ceiling_held : counters_.clamped);
  }
  // Rises use two periods at most; a fade to zero uses the whole elapsed time.
  const double step_n = 1000.0 * limits_.slew_n_per_ms * (giving ? std::min(dt_s, kLongestRise_s) : dt_s);
  bool held = false;
  // A fade starts from the force last applied, which the brake or the motors may have reduced.
  slewed_ = approach(giving ? slewed_ : output_, target, step_n, held);
  counters_.slewed += held ? 1 : 0;

  glm::dvec3 force = slewed_;
  if (giving && limit_n > 0.0) force = limitSpeed(force, input.velocity_mm_per_s);
  force *= motorFactor(force);
  const double thermal_n = thermalLimit();
  if (glm::length(force) > thermal_n) {
    ++counters_.thermal;
    force *= thermal_n / glm::length(force);
  }
  if (limits_.peak_force_n > 0.0) force = clampForce(force, limits_.peak_force_n).force_n;
  if (giving && input.output_pending) force = limitRiseFromHeld(force);
  return output_ = approach(output_, force, step_n, held);
}

}  // namespace fettle::haptic
