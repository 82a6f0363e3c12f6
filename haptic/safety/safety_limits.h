#pragma once

#include <optional>
#include <string>

#include <glm/vec3.hpp>

namespace fettle::haptic {

struct DeviceProfile;

/// The part of a force that the motors can apply: a factor 0 .. 1 on the whole vector, so that its direction
/// is kept. The device computes it from its Jacobian and its currents; the guard only applies it. A result
/// outside 0 .. 1 or not finite counts as 0. noexcept is part of the type; called on the haptic thread:
/// wait-free.
struct MotorScale {
  double (*factor)(const void* device, const glm::dvec3& force_n) noexcept = nullptr;  ///< null = 1
  const void* device = nullptr;
};

/// Limits of the force for a device. The defaults are those of an unknown device (3 N, 4 N s/m: the weakest
/// stylus in common use); a profile raises them.
struct SafetyLimits {
  double peak_force_n = 3.0;        ///< largest |force| [N], 0 .. 1000; 0 = no force
  double continuous_force_n = 1.2;  ///< |force| the motors can hold permanently [N], 0 .. peak
  /// Thermal time constant of the motors [s], >= 0.1: at peak force from cold they reach the allowed warmth
  /// after -tau ln(1 - (continuous / peak)^2).
  double thermal_tau_s = 20.0;
  /// Largest change of the force vector [N/ms], > 0. 1 N/ms is a 1 N/mm wall hit at 1 m/s.
  double slew_n_per_ms = 0.6;
  /// Time in which a ramp reaches the peak force [s], 0.5 .. 1.
  double ramp_s = 0.5;
  /// Above this speed of the tip, force no longer accelerates it, and it is damped [mm/s], > 0.
  double speed_limit_mm_per_s = 1500.0;
  /// Brake above the speed limit [N s/mm], >= 0; at most what the device damps stably (published B).
  double damping_n_s_per_mm = 0.004;
  /// Above this the pose jumped: a hand reaches 4 m/s, an encoder error any value [mm/s].
  double jump_speed_mm_per_s = 8000.0;
  /// A rise of the commanded force not caused by the hand (see Disturbance) is applied immediately up to this
  /// [N], and ramped beyond. Also what counts as "small" before the first contact is felt.
  double small_force_n = 0.1;
  double silence_s = 0.010;  ///< no good input for this long: zero force
  double fault_s = 0.050;    ///< no good input for this long: Fault
  MotorScale motors;
};

/// A value out of range, as one sentence; empty when all are valid.
[[nodiscard]] std::optional<std::string> limitsProblem(const SafetyLimits& limits);

/// The limits of a device by its profile. Values that a profile does not state are chosen low: continuous
/// force
/// 40 % of the peak (the ratio of stall to continuous torque of small coreless motors is 2.5 and more), slew
/// of the whole peak in 5 ms, brake as much as the device is known to damp stably.
[[nodiscard]] SafetyLimits limitsFor(const DeviceProfile& profile) noexcept;

}  // namespace fettle::haptic
