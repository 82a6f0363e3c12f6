#pragma once

#include <cstdint>

#include <glm/vec3.hpp>

#include "haptic/surface.h"

namespace fettle::haptic {

/// How a search came to its end.
enum class SearchEnd : std::uint8_t {
  kAtRest,  ///< no neighbour is nearer
  kBound,   ///< stopped by kMaxCellsVisited; the point is on the surface, the next tick goes on from it
  kHole,    ///< the start cell has a hole: no point
};

struct SearchResult {
  SurfacePoint point;
  SearchEnd end = SearchEnd::kHole;
  int cells = 0;  ///< cells moved through, the start included
};

/// Cells one search may move through. At 1 kHz and 0.05 mm a cell a hand at 2 m/s crosses 40 a tick; the
/// bound keeps the worst tick near 50 microseconds.
inline constexpr int kMaxCellsVisited = 512;

/// Level paper: the local closest point. The bounded closest point of the start cell, going down from (u, v);
/// while it lies on an edge or a vertex, the same in each cell that shares it, moving to the nearest; stops
/// when none is nearer. Every move makes the distance strictly smaller, so that it ends in any concave
/// corner. `start` is a cell of the field, u and v are in [0, 1].
///
/// Source: Potter, Johnson, Cohen, DETC2004-57539, "Haptic Rendering". Guarantee: wait-free, noexcept.
[[nodiscard]] SearchResult searchClosest(Surface& surface, const glm::dvec3& endpoint, CellIndex start,
                                         double u, double v) noexcept;

}  // namespace fettle::haptic
