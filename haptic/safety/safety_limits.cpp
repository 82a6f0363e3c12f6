#include "haptic/safety/safety_limits.h"

#include <algorithm>

#include "haptic/devices/device.h"

namespace fettle::haptic {

namespace {

// Negated comparisons, so that NaN is out of range.
bool within(double value, double low, double high) noexcept {
  return value >= low && value <= high;
}

}  // namespace

std::optional<std::string> limitsProblem(const SafetyLimits& limits) {
  if (!within(limits.peak_force_n, 0.0, 1000.0)) return "the peak force is not within 0 to 1000 N";
  if (!within(limits.continuous_force_n, 0.0, limits.peak_force_n))
    return "the continuous force is not within 0 and the peak force";
  if (!within(limits.thermal_tau_s, 0.1, 1e6)) return "the thermal time constant is not within 0.1 to 1e6 s";
  if (!within(limits.slew_n_per_ms, 1e-6, 1e6)) return "the slew limit is not within 1e-6 to 1e6 N/ms";
  if (!within(limits.ramp_s, 0.5, 1.0)) return "the ramp is not within 0.5 to 1 s";
  if (!within(limits.speed_limit_mm_per_s, 1.0, 1e6)) return "the speed limit is not within 1 to 1e6 mm/s";
  if (!within(limits.damping_n_s_per_mm, 0.0, 1.0)) return "the brake is not within 0 to 1 N s/mm";
  if (!within(limits.jump_speed_mm_per_s, limits.speed_limit_mm_per_s, 1e9))
    return "the jump speed is below the speed limit";
  if (!within(limits.small_force_n, 0.0, 1.0)) return "the small force is not within 0 to 1 N";
  if (!within(limits.silence_s, 0.001, 1.0)) return "the silence limit is not within 0.001 to 1 s";
  if (!within(limits.fault_s, limits.silence_s, 10.0))
    return "the fault limit is not within the silence limit and 10 s";
  return std::nullopt;
}

SafetyLimits limitsFor(const DeviceProfile& profile) noexcept {
  SafetyLimits limits;
  // A profile is read from a file: a value out of range gives no force at all.
  const bool sensible = within(profile.max_force_n, 0.0, 1000.0);
  limits.peak_force_n = sensible ? profile.max_force_n : 0.0;
  limits.continuous_force_n = 0.4 * limits.peak_force_n;
  limits.slew_n_per_ms = std::max(limits.peak_force_n / 5.0, 0.01);
  limits.small_force_n = std::min(0.1, 0.05 * limits.peak_force_n);
  limits.damping_n_s_per_mm =
      within(profile.max_damping_n_s_per_mm, 0.0, 1.0) ? profile.max_damping_n_s_per_mm : 0.0;
  return limits;
}

}  // namespace fettle::haptic
