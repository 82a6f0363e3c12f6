#pragma once

#include <optional>
#include <string>

#include "engine/field/grid.h"
#include "haptic/devices/device.h"
#include "haptic/effects/stability.h"
#include "haptic/safety/safety_limits.h"
#include "haptic/scene/scene.h"

namespace fettle::app {

/// The scale [mm of the field per mm of the hand] at which the smaller side of the field is within the device's reach; 0 for a field
/// of one row or column.
[[nodiscard]] double reachScale(const haptic::DeviceProfile& profile, const engine::Grid& grid);

/// The longest reach of edge snap on a field, by which its stability is judged (haptic/effects/stability.h).
[[nodiscard]] double longestSnapMm(const engine::Grid& grid);

/// For a scene that the user gave, which is not fitted (fitted_scene.h): the scale at which the smaller side of the field is within the
/// device's reach, or for a device that gives force the largest at which the scene is stable
/// (haptic::stability.h) if that is less; 1 for a field of one row or column. Also 1 for a device on which
/// the scene is not stable at any scale: see its stabilityProblem.
[[nodiscard]] double fittedScale(const haptic::DeviceProfile& profile, const engine::Grid& grid,
                                 const haptic::Scene& scene, double rate_hz);

/// For sessions without a force device, where nothing can become unstable: the problem of a scene that is not
/// stable on any device with known limits (haptic::knownDevices), at 1:1, or larger where the whole field is
/// then within reach: the largest value on the device that holds most. Empty when the scene is stable on one
/// of them.
[[nodiscard]] std::optional<haptic::StabilityProblem> problemOnEveryDevice(const haptic::Scene& scene,
                                                                           const engine::Grid& grid,
                                                                           double rate_hz);
/// The same as one line for a warning.
[[nodiscard]] std::string withoutForceText(const haptic::StabilityProblem& problem);

/// Limits of a session on this device: zero force for a device that gives none.
[[nodiscard]] haptic::SafetyLimits sessionLimits(haptic::DeviceProfile profile);

}  // namespace fettle::app
