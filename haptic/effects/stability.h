#pragma once

#include <limits>
#include <optional>
#include <string>

#include "haptic/devices/device.h"
#include "haptic/scene/scene.h"

namespace fettle::haptic {

/// Where no field is known: edge snap has the reach that its scene states.
inline constexpr double kAnyReach_mm = std::numeric_limits<double>::infinity();

/// What a scene needs of the device's own damping, by the conditions that each effect's header states.
struct StabilityNeed {
  double stiffness_n_per_mm = 0.0;         ///< largest that the hand feels, across or along the surface
  double damping_n_s_per_mm = 0.0;         ///< that the scene itself adds (viscosity, coupling, brake)
  double device_damping_n_s_per_mm = 0.0;  ///< needed: K T / 2 + b a / (2 - a)
};

/// At `rate_hz` > 0. Across: K (1 + s^2) + F_max c with a texture; along: friction's stiffness and edge
/// snap's 4 F / R together. `scene` in range.
[[nodiscard]] StabilityNeed stabilityNeed(const Scene& scene, double rate_hz) noexcept;

/// Numbers of a scene with which a device is not stable.
struct StabilityProblem {
  std::string what;    ///< a sentence: the value requested, and what the device holds
  std::string remedy;  ///< names the largest stable value
  /// That value, rounded down to four digits, so that the value displayed in `remedy` is stable when typed:
  /// stiffness [N/mm], amplitude [mm], force [N] or damping [N s/mm], whichever `what` is about.
  double largest = 0.0;
  Scene corrected;  ///< the scene with the numbers named in `remedy`, and only these, lowered to its values
};

/// The first value of the scene above what the device is known to hold stably; nothing when there is none.
///
/// A profile states the largest damping (B) and stiffness (K) with which a device is stable at 1 kHz; K is
/// proportional to the rate (2 b / T). A rate above the device's own gives no more than that: between two
/// inputs the force is constant. `scale` [mm of the field per mm of the hand, > 0]: stiffness and damping of
/// the scene are felt that many times as large (Workspace). With a texture the force goes up to the scene's
/// limit or the device's, whichever is less. `longest_reach_mm`: of edge snap on the field (MarkDistance::longestReachMm), whose
/// pull is as stiff as the reach is short.
///
/// Where two numbers share what is held - stiffness and a texture, friction and edge snap - the largest
/// stiffness with the other unchanged is named as long as that is at least a tenth of what is held; otherwise
/// the largest value of the other, with the stiffness at most half of what is held.
[[nodiscard]] std::optional<StabilityProblem> stabilityProblem(const Scene& scene,
                                                               const DeviceProfile& profile, double rate_hz,
                                                               double scale = 1.0,
                                                               double longest_reach_mm = kAnyReach_mm);

/// To four digits, so that a value typed as it is displayed is not above a limit; 0 of one that is not above 0.
[[nodiscard]] double roundedDown(double value) noexcept;

/// Largest stiffness [N/mm] of the spring that the device holds with the rest of the scene, rounded down to
/// four digits; 0 when it holds none. As stabilityProblem().
[[nodiscard]] double largestStiffness(const Scene& scene, const DeviceProfile& profile, double rate_hz,
                                      double scale = 1.0);

/// The scene with every problem corrected (StabilityProblem::corrected): unchanged when there is none.
[[nodiscard]] Scene stableScene(Scene scene, const DeviceProfile& profile, double rate_hz, double scale = 1.0,
                                double longest_reach_mm = kAnyReach_mm);

/// The largest scale at which the device holds the scene as it is, rounded down to four digits: infinite for
/// a scene without stiffness and damping, 0 for a device that holds none.
[[nodiscard]] double largestStableScale(const Scene& scene, const DeviceProfile& profile, double rate_hz,
                                        double longest_reach_mm = kAnyReach_mm);

}  // namespace fettle::haptic
