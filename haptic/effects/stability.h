#pragma once

#include <optional>
#include <string>

#include "haptic/devices/device.h"
#include "haptic/scene.h"

namespace fettle::haptic {

/// What a scene asks of the device's own damping, by the conditions that each effect's header states.
struct StabilityNeed {
  double stiffness_n_per_mm = 0.0;         ///< largest that the hand meets, across or along the surface
  double damping_n_s_per_mm = 0.0;         ///< that the scene itself adds (viscosity, coupling, brake)
  double device_damping_n_s_per_mm = 0.0;  ///< needed: K T / 2 + b a / (2 - a)
};

/// At `rate_hz` > 0. Across: K (1 + s^2) + F_max c with a texture; along: friction's stiffness and edge
/// snap's 4 F / R together. `scene` in range.
[[nodiscard]] StabilityNeed stabilityNeed(const Scene& scene, double rate_hz) noexcept;

/// What of the scene is more than the device is known to hold, as one sentence for the user; nothing when all
/// is well. A profile says how much damping a device can be asked for (B) and which stiffness it holds (K),
/// at 1 kHz; at another rate K goes with the rate (2 b / T). Stiffness is as felt by the device: with a
/// Workspace of scale other than 1, in the device's own millimetres.
[[nodiscard]] std::optional<std::string> stabilityProblem(const Scene& scene, const DeviceProfile& profile,
                                                          double rate_hz);

}  // namespace fettle::haptic
