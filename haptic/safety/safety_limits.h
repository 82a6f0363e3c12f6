#pragma once

#include <optional>
#include <string>

#include <glm/vec3.hpp>

namespace fettle::haptic {

struct DeviceProfile;

/// How much of a force the motors can give: a factor 0 .. 1 on the whole vector, so that its direction stays.
/// The device knows its Jacobian and its currents; the guard only applies the factor. A result outside 0 .. 1
/// or not finite counts as 0. noexcept is part of the type; called on the haptic thread: wait-free.
struct MotorScale {
  double (*factor)(const void* device, const glm::dvec3& force_n) noexcept = nullptr;  ///< null = 1
  const void* device = nullptr;
};

/// What a device may be given, and how the guard treats the hand. The defaults are those of an unknown device
/// (3 N, 4 N s/m: the weakest stylus in common use); a profile raises them.
struct SafetyLimits {
  double peak_force_n = 3.0;        ///< largest |force| ever given [N], 0 .. 1000; 0 = none ever
  double continuous_force_n = 1.2;  ///< |force| the motors hold for ever [N], 0 .. peak
  /// Thermal time constant of the motors [s], >= 0.1: at peak force from cold they are as warm as they may be
  /// after -tau ln(1 - (continuous / peak)^2).
  double thermal_tau_s = 20.0;
  /// Largest change of the force vector [N/ms], > 0. 1 N/ms is a 1 N/mm wall met at 1 m/s.
  double slew_n_per_ms = 0.6;
  /// Time in which a ramp reaches the peak force [s], 0.5 .. 1.
  double ramp_s = 0.5;
  /// Above this speed of the tip force no longer drives it on, and it is braked [mm/s], > 0.
  double speed_limit_mm_per_s = 1500.0;
  /// Brake above the speed limit [N s/mm], >= 0; at most what the device damps stably (published B).
  double damping_n_s_per_mm = 0.004;
  /// Above this the pose jumped: a hand reaches 4 m/s, an encoder glitch any number [mm/s].
  double jump_speed_mm_per_s = 8000.0;
  /// A rise of the commanded force that no hand did (see Disturbance) is given at once up to this [N], and
  /// ramped beyond. Also what counts as "small" before the first contact is felt.
  double small_force_n = 0.1;
  double silence_s = 0.010;  ///< no good input for this long: zero force
  double fault_s = 0.050;    ///< no good input for this long: Fault
  MotorScale motors;
};

/// A value out of range, as one sentence; nothing when all is well.
[[nodiscard]] std::optional<std::string> limitsProblem(const SafetyLimits& limits);

/// The limits of a device by its profile. What a profile does not say is taken with care: continuous force
/// 40 % of the peak (the ratio of stall to continuous torque of small coreless motors is 2.5 and more), slew
/// of the whole peak in 5 ms, brake as much as the device is known to damp stably.
[[nodiscard]] SafetyLimits limitsFor(const DeviceProfile& profile) noexcept;

}  // namespace fettle::haptic
