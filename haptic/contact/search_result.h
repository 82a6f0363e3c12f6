#pragma once

#include <cstdint>

#include "haptic/contact/surface.h"

namespace fettle::haptic {

/// How a search came to its end.
enum class SearchEnd : std::uint8_t {
  kAtRest,  ///< no neighbour is nearer
  kBound,   ///< stopped by its bound; the point is on the surface, the next tick continues from it
  kHole,    ///< the start cell has a hole: no point
};

/// What a local search of the closest point found: searchClosest (level paper), searchDownhill (level descent).
struct SearchResult {
  SurfacePoint point;
  SearchEnd end = SearchEnd::kHole;
  /// At rest, and every cell that shares the point exists: neither a hole nor the field's border ends the
  /// search early, so the penetration vector is made of these cells' normals with weights of one sign.
  bool ringed = false;
  int cells = 0;  ///< cells moved through, the start included
};

}  // namespace fettle::haptic
