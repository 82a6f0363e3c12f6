#include "app/live/placement.h"

#include <algorithm>

#include "haptic/devices/workspace.h"

namespace fettle::app {

double stiffestScale(const haptic::DeviceProfile& profile, double stiffness_n_per_mm) noexcept {
  return profile.max_stiffness_n_per_mm / stiffness_n_per_mm;
}

double fittedScale(const haptic::DeviceProfile& profile, const engine::Grid& grid,
                   double stiffness_n_per_mm) noexcept {
  const double side = std::min((grid.width - 1) * grid.spacingXMm(), (grid.height - 1) * grid.spacingYMm());
  const double reach = haptic::Workspace::fit(profile, glm::dvec3(0.0), side).scale();
  const double scale =
      profile.gives_force ? std::min(reach, stiffestScale(profile, stiffness_n_per_mm)) : reach;
  return scale > 0.0 ? scale : 1.0;
}

haptic::SafetyLimits sessionLimits(haptic::DeviceProfile profile) {
  if (!profile.gives_force) profile.max_force_n = 0.0;
  return haptic::limitsFor(profile);
}

}  // namespace fettle::app
