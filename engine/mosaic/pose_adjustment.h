#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/base/error.h"
#include "engine/measure/align.h"
#include "engine/measure/rigid_motion.h"

namespace fettle::engine {

/// How one scan lies against another: alignFields() of two of them.
struct PairMotion {
  std::size_t first = 0, second = 0;
  RigidMotion
      motion;  ///< from the second's field coordinates to the first's; its centre lies in the first's part of both
  /// Of a shift [mm] and a turn about motion.centre [rad] beyond, row-major: x, y, z, about x, y, z; 0 where not free.
  std::array<double, 36> covariance{};
};

/// Where all scans lie after one adjustment of all of them.
struct AdjustedPoses {
  std::vector<RigidMotion>
      poses;  ///< to the first scan's field coordinates, each about its scan's middle there
  /// Of the unknowns [mm, mm per arm]: six for each scan but the first, row-major; what is not free is 0.
  std::vector<double> covariance;
  double arm = 1.0;     ///< turns are counted as shifts so far from the middle [mm]
  double misfit = 0.0;  ///< sum of squares of what remains of the pairs, in their standard errors
  int freedom = 0;      ///< figures of pairs beyond those that determine the poses: 0 without a loop
  /// By which the standard errors of pairs were multiplied: the root of misfit / freedom where that is above 1.
  double factor = 1.0;

  /// Covariance of a shift and a turn about `place` (in the first scan's coordinates) by which scan b moves against scan a,
  /// as PairMotion::covariance.
  [[nodiscard]] std::array<double, 36> between(std::size_t a, std::size_t b, const glm::dvec3& place) const;
  /// Standard error of the height of scan b over scan a at a level place [mm].
  [[nodiscard]] double heightError(std::size_t a, std::size_t b, const glm::dvec3& place) const;
};

/// The poses for which the sum of squares of all pairs' misfits, each by its covariance, is least, with the first scan where
/// it is: Gauss-Newton from a tree of the surest pairs (F. Lu and E. Milios, Globally consistent range scan alignment, 1997).
/// `middles`: of each scan, in its own field coordinates. To first order that is the least squares over
/// the overlaps themselves, whose curvature the covariances are. `moves`: those that pairs were aligned by.
/// Errors: kInput, `where` is the number of a scan that no chain of pairs joins to the first. Throws std::bad_alloc.
/// Cost: (6 n)^3 steps for n scans. Thread: any.
[[nodiscard]] Result<AdjustedPoses> adjustPoses(const std::vector<glm::dvec3>& middles,
                                                const std::vector<PairMotion>& pairs,
                                                const AlignMoves& moves);

}  // namespace fettle::engine
