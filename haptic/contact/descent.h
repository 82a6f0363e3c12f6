#pragma once

#include <glm/vec3.hpp>

#include "haptic/base/search_limits.h"
#include "haptic/contact/search_result.h"
#include "haptic/contact/surface.h"

namespace fettle::haptic {

/// Level descent: down from the last point. From (u, v) of the start cell distance goes down by Newton's method;
/// at a side it tests the cell beyond, at a vertex the three others, and continues there when distance falls
/// there, else along the side; it stops where distance falls into none of the cells that share the point.
/// Every step makes the distance smaller, so that it terminates in any concave corner. `start` is a cell of
/// the field, u and v are in [0, 1].
///
/// Differs from the source's search, level paper: there the bounded closest point of each cell is found before
/// its neighbours are tested, and the nearest of these is taken, also where distance first rises on the way to it.
/// This one stops at more local minima: `fettle accuracy` shows its price.
///
/// `most_rounds`, 2 .. kMaxRounds, the last of which only tests: fewer than a search needs to end at rest is
/// a cheaper search, whose error `fettle accuracy` measures; the next tick continues where this one stopped
/// (SearchEnd::kBound).
///
/// Source: projected Newton steps: Nocedal and Wright, "Numerical Optimization" (2006), section 16.7. Guarantee:
/// wait-free, noexcept.
[[nodiscard]] SearchResult searchDownhill(Surface& surface, const glm::dvec3& endpoint, CellIndex start,
                                          double u, double v, int most_rounds = kMaxRounds) noexcept;

}  // namespace fettle::haptic
