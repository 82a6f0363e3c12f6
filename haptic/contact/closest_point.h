#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

#include "haptic/base/search_limits.h"
#include "haptic/contact/surface.h"

namespace fettle::haptic {

/// How a search came to its end.
enum class SearchEnd : std::uint8_t {
  kAtRest,  ///< no neighbour is nearer
  kBound,   ///< stopped by kMaxCellsVisited; the point is on the surface, the next tick continues from it
  kHole,    ///< the start cell has a hole: no point
};

struct SearchResult {
  SurfacePoint point;
  SearchEnd end = SearchEnd::kHole;
  /// At rest, and every cell that shares the point exists: neither a hole nor the field's border ends the
  /// search early, so the penetration vector is made of these cells' normals with weights of one sign.
  bool ringed = false;
  int cells = 0;  ///< cells moved through, the start included
};

/// Level paper: the local closest point. From (u, v) of the start cell distance goes down by Newton's method;
/// at a side it tests the cell beyond, at a vertex the three others, and continues there when distance falls
/// there, else along the side; it stops where distance falls into none of the cells that share the point.
/// Every step makes the distance smaller, so that it terminates in any concave corner. `start` is a cell of
/// the field, u and v are in [0, 1].
///
/// Departs from the source in one thing: there the bounded closest point of each cell is found before its
/// neighbours are tested, and the nearest of these is taken. Both stop by the same test, so both end in local
/// minima; from a point with several descending directions these may differ: of 4000 searches over noise 226
/// do, 138 of them ended farther and 88 nearer than the source's, at the same mean distance
/// (tests/haptic/tick/tick_test.cpp). To cross a cell this takes 1 to 3 rounds instead of 5 to 10.
///
/// `most_rounds`, 2 .. kMaxRounds, the last of which only tests: fewer than a search needs to end at rest is
/// a cheaper level, whose error `fettle accuracy` measures; the next tick continues where this one stopped
/// (SearchEnd::kBound).
///
/// Source: Potter, Johnson, Cohen, DETC2004-57539, "Haptic Rendering"; projected Newton steps: Nocedal and
/// Wright, "Numerical Optimization" (2006), section 16.7. Guarantee: wait-free, noexcept.
[[nodiscard]] SearchResult searchClosest(Surface& surface, const glm::dvec3& endpoint, CellIndex start,
                                         double u, double v, int most_rounds = kMaxRounds) noexcept;

}  // namespace fettle::haptic
