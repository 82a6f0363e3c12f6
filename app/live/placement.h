#pragma once

#include "engine/field/grid.h"
#include "haptic/devices/device.h"
#include "haptic/safety/safety_limits.h"

namespace fettle::app {

/// Stiffest scale [mm of the field a mm of the hand] at which a spring of `stiffness_n_per_mm` > 0 in the
/// field is felt no stiffer than the device holds: it is felt as scale times that (haptic::Workspace).
[[nodiscard]] double stiffestScale(const haptic::DeviceProfile& profile, double stiffness_n_per_mm) noexcept;

/// The scale that brings the smaller side of the field within the device's reach, or the stiffest if that is
/// less and the device gives force; 1 for a field of one row or column.
[[nodiscard]] double fittedScale(const haptic::DeviceProfile& profile, const engine::Grid& grid,
                                 double stiffness_n_per_mm) noexcept;

/// Limits of a session on this device: none but zero force for one that gives none.
[[nodiscard]] haptic::SafetyLimits sessionLimits(haptic::DeviceProfile profile);

}  // namespace fettle::app
