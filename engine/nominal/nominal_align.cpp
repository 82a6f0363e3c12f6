#include "engine/nominal/nominal_align.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <optional>

#include <glm/geometric.hpp>

#include "engine/nominal/nominal_surface.h"

namespace fettle::engine {

namespace {

constexpr double kMostSamples = 1 << 22;

// The samples at which a nominal is seen from above, its lower left corner the first.
Grid gridOver(const NominalMesh& nominal, const Grid& part) {
  const glm::dvec3 size = nominal.box().high - nominal.box().low;
  double sx = part.spacingXMm(), sy = part.spacingYMm();
  const double samples = (size.x / sx + 1.0) * (size.y / sy + 1.0);
  const double coarser = std::max({1.0, std::sqrt(samples / kMostSamples), size.x / sx / (Grid::kMaxSide - 1),
                                   size.y / sy / (Grid::kMaxSide - 1)});
  sx *= coarser;
  sy *= coarser;
  Grid grid;
  grid.width = static_cast<std::int32_t>(size.x / sx * (1.0 + 1e-12)) + 1;
  grid.height = static_cast<std::int32_t>(size.y / sy * (1.0 + 1e-12)) + 1;
  grid.spacing_x = sx;
  grid.spacing_y = sy;
  grid.origin_x = nominal.corner().x;
  grid.origin_y = nominal.corner().y;
  return grid;
}

// `motion` after points were shifted by -`by`: for those points themselves.
RigidMotion beforeShift(const RigidMotion& motion, const glm::dvec3& by) noexcept {
  RigidMotion all = motion;
  all.shift -= motion.rotation * by;
  return all;
}

// One motion, then another, about the centre of the first.
RigidMotion oneAfterAnother(const RigidMotion& first, const RigidMotion& second) noexcept {
  return {second.rotation * first.rotation, second.moved(first.moved(first.centre)) - first.centre,
          first.centre};
}

// How far a motion moves the corners of a grid, at most [mm].
double movesCorners(const RigidMotion& motion, const Grid& grid) noexcept {
  const double w = (grid.width - 1) * grid.spacingXMm(), h = (grid.height - 1) * grid.spacingYMm();
  double most = 0.0;
  for (const double x : {0.0, w})
    for (const double y : {0.0, h}) {
      const glm::dvec3 p(x, y, motion.centre.z);
      most = std::max(most, glm::length(motion.moved(p) - p));
    }
  return most;
}

}  // namespace

Result<Alignment> alignNominal(const Version& part, const NominalMesh& nominal, const AlignOptions& options,
                               JobControl& job) try {
  constexpr int kRounds = 4;
  constexpr double kOfError = 0.1;
  const Grid& grid = part.grid();
  const Grid over = gridOver(nominal, grid);
  // Heights about the nominal's middle: float keeps their digits.
  const glm::dvec3 middle(0.0, 0.0, 0.5 * (nominal.box().low.z + nominal.box().high.z));
  RigidMotion down;
  down.shift = -middle;
  auto seen = nominalHeights(NominalSurface(nominal, down, slackOn(over, nominal)), over, job);
  if (!seen) return tl::unexpected(seen.error());
  auto found = alignFields(part, *seen, options, job);
  if (!found) return found;
  RigidMotion motion = beforeShift(found->motion, middle);
  const std::optional<glm::dvec2> repeat = found->repeat;
  AlignOptions again = options;
  again.search = false;
  for (int round = 0; round < kRounds; ++round) {
    seen = nominalHeights(NominalSurface(nominal, motion, slackOn(grid, nominal)), grid, job);
    if (!seen) return tl::unexpected(seen.error());
    found = alignFields(part, *seen, again, job);
    if (!found) return found;
    motion = oneAfterAnother(motion, found->motion);
    const double arm = 0.5 * std::hypot(grid.width * grid.spacingXMm(), grid.height * grid.spacingYMm());
    const glm::dvec3 turned(found->covariance[21], found->covariance[28], found->covariance[35]);
    const double error = std::sqrt(found->covariance[0] + found->covariance[7] + found->covariance[14] +
                                   arm * arm * (turned.x + turned.y + turned.z));
    if (movesCorners(found->motion, grid) < kOfError * error) break;
  }
  Alignment result = *found;
  // About the middle of the part, as alignFields states it.
  result.motion = motion;
  result.angles = motion.angles();
  result.repeat = repeat;  // the search's; the others only refine
  return result;
} catch (const std::bad_alloc&) {
  return failure("memory is exhausted", "aligning", "align a smaller part");
}

}  // namespace fettle::engine
