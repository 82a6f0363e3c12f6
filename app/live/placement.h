#pragma once

#include <optional>
#include <string>

#include "engine/field/grid.h"
#include "haptic/devices/device.h"
#include "haptic/effects/stability.h"
#include "haptic/safety/safety_limits.h"
#include "haptic/scene/scene.h"

namespace fettle::app {

/// The scale [mm of the field a mm of the hand] that brings the smaller side of the field within the device's
/// reach, or for a device that gives force the largest at which it holds the scene (haptic::stability.h) if
/// that is less; 1 for a field of one row or column. 1 as well for a device that holds nothing of the scene:
/// its stabilityProblem says so.
[[nodiscard]] double fittedScale(const haptic::DeviceProfile& profile, const engine::Grid& grid,
                                 const haptic::Scene& scene, double rate_hz);

/// Without a device that gives force nothing can buzz. What is said of a scene that no device with known
/// limits (haptic::knownDevices) would hold, felt at 1:1, or larger where the whole field is within reach
/// then: the largest value on the device that holds most. Nothing when one of them holds it all.
[[nodiscard]] std::optional<haptic::StabilityProblem> problemOnEveryDevice(const haptic::Scene& scene,
                                                                           const engine::Grid& grid,
                                                                           double rate_hz);
/// The same as one line to warn with.
[[nodiscard]] std::string withoutForceText(const haptic::StabilityProblem& problem);

/// Limits of a session on this device: none but zero force for one that gives none.
[[nodiscard]] haptic::SafetyLimits sessionLimits(haptic::DeviceProfile profile);

}  // namespace fettle::app
