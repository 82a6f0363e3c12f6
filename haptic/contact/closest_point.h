#pragma once

#include <cmath>

#include <glm/vec3.hpp>

#include "haptic/contact/search_result.h"
#include "haptic/contact/surface.h"

namespace fettle::haptic {

/// Level paper: the source's search for the local closest point. The bounded closest point of the start cell is found;
/// where it lies on an edge or vertex, those of all cells that share it, too. The shortest distance is kept: where it is a
/// neighbour's, the search moves there and looks at its neighbours; where it is the cell's own, the search is at
/// rest. A bounded closest point is the nearest of the whole cell (closestOnCell), so that the result depends on the
/// start cell alone; (u, v), where it probably is, decides only the time.
///
/// "Shorter" means by more than rounding, shorterThan(), so that a point that several cells share keeps its cell. Distance
/// falls with every move, and at most kMaxCellsVisited cells are moved through (SearchEnd::kBound).
///
/// Neighbours that cannot be nearer are not solved: a patch lies in the hull of its corners, and mostly all of them lie
/// behind the plane through the point and across the line to the endpoint.
///
/// `start` is a cell of the field, u and v are in [0, 1]. Source: Potter, Johnson, Cohen, DETC2004-57539, "Haptic
/// Rendering". Guarantee: wait-free, noexcept.
[[nodiscard]] SearchResult searchClosest(Surface& surface, const glm::dvec3& endpoint, CellIndex start,
                                         double u, double v) noexcept;

/// A squared distance to the endpoint below this is shorter than `distance2_mm2` by more than rounding: of the squares, and
/// of coordinates as large as the endpoint's, which moves a point by some 4e-15 of them. A factor of the distance
/// alone does not do: it would hold a point aside on a flat by its root times the distance.
[[nodiscard]] inline double shorterThan(double distance2_mm2, const glm::dvec3& endpoint) noexcept {
  const double size_mm = std::abs(endpoint.x) + std::abs(endpoint.y) + std::abs(endpoint.z);
  return distance2_mm2 - 4e-15 * (distance2_mm2 + std::sqrt(distance2_mm2) * size_mm);
}

}  // namespace fettle::haptic
