#include "app/live/placement.h"

#include <algorithm>

#include <fmt/format.h>

#include "haptic/devices/known_devices.h"
#include "haptic/devices/workspace.h"
#include "haptic/effects/mark_distance.h"

namespace fettle::app {

double reachScale(const haptic::DeviceProfile& profile, const engine::Grid& grid) {
  const double side = std::min((grid.width - 1) * grid.spacingXMm(), (grid.height - 1) * grid.spacingYMm());
  return haptic::Workspace::fit(profile, glm::dvec3(0.0), side).scale();
}

double longestSnapMm(const engine::Grid& grid) {
  return haptic::MarkDistance::longestReachMm(grid);
}

double fittedScale(const haptic::DeviceProfile& profile, const engine::Grid& grid, const haptic::Scene& scene,
                   double rate_hz) {
  const double reach = reachScale(profile, grid);
  const double scale =
      profile.gives_force
          ? std::min(reach, haptic::largestStableScale(scene, profile, rate_hz, longestSnapMm(grid)))
          : reach;
  return scale > 0.0 ? scale : 1.0;
}

std::optional<haptic::StabilityProblem> problemOnEveryDevice(const haptic::Scene& scene,
                                                             const engine::Grid& grid, double rate_hz) {
  std::optional<haptic::StabilityProblem> best;
  double held = -1.0;  // largest stable scale of the scene over the devices
  const double longest_reach_mm = longestSnapMm(grid);
  for (const haptic::KnownDevice& known : haptic::knownDevices()) {
    const haptic::DeviceProfile profile = *haptic::knownProfile(known.name);
    const double reach = reachScale(profile, grid);
    const double scale = reach > 0.0 ? std::min(reach, 1.0) : 1.0;
    auto problem = haptic::stabilityProblem(scene, profile, rate_hz, scale, longest_reach_mm);
    if (!problem) return std::nullopt;
    const double share = haptic::largestStableScale(scene, profile, rate_hz, longest_reach_mm) / scale;
    if (share <= held) continue;
    held = share;
    best = std::move(problem);
  }
  return best;
}

std::string withoutForceText(const haptic::StabilityProblem& problem) {
  return fmt::format("this device gives no force, but on no known device would this scene be stable: {}: {}",
                     problem.what, problem.remedy);
}

haptic::SafetyLimits sessionLimits(haptic::DeviceProfile profile) {
  if (!profile.gives_force) profile.max_force_n = 0.0;
  return haptic::limitsFor(profile);
}

}  // namespace fettle::app
