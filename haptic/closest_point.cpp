#include "haptic/closest_point.h"

#include "haptic/pair.h"
#include "haptic/patch_inl.h"
#include "haptic/sharing.h"

#include <utility>

namespace fettle::haptic {

namespace {

// Whether distance only grows from a shared point into this patch. On an edge the point is already the
// nearest along it, so only the way across is looked at; at a vertex both ways are. Most neighbours end here.
[[gnu::always_inline]] inline bool restsHere(const Patch& s, const glm::dvec3& e, double u,
                                             double v) noexcept {
  const Pair at{u, v};
  const Pair spacing{s.sx, s.sy};
  const Pair pq = Pair{s.b, s.c} + Pair{s.d, s.d} * swapped(at);
  const double z = s.a + s.b * u + pq[1] * v - e.z;
  const Pair g = spacing * (Pair{s.x0, s.y0} + spacing * at - Pair{e.x, e.y}) + Pair{z, z} * pq;
  const Pair zero{0.0, 0.0};
  const Pair one{1.0, 1.0};
  return lanes(either(butNot(equal(at, zero), atMost(zero, g)), butNot(equal(at, one), atMost(g, zero)))) ==
         0;
}

}  // namespace

SearchResult searchClosest(Surface& surface, const glm::dvec3& endpoint, CellIndex start, double u,
                           double v) noexcept {
  SearchResult result;
  // Three places for patches that change roles by their addresses: where the search is, the best neighbour so
  // far, the one looked at.
  Patch patches[3];
  Patch* here = &patches[0];
  Patch* nearest_patch = &patches[1];
  Patch* looked_at = &patches[2];
  if (!surface.patch(start, *here)) return result;
  CellIndex cell = start;
  PatchPoint best = detail::descendPatch(*here, endpoint, u, v);
  result.end = SearchEnd::kBound;
  for (result.cells = 1; result.cells < kMaxCellsVisited; ++result.cells) {
    const Pair at{best.u, best.v};
    if (lanes(either(equal(at, Pair{0.0, 0.0}), equal(at, Pair{1.0, 1.0}))) == 0) {
      result.end = SearchEnd::kAtRest;  // inside the cell, shared with none
      break;
    }
    CellIndex nearest_cell = cell;
    PatchPoint nearest = best;
    // Going down from the shared point, each neighbour offers a point at least as near; only a strictly
    // nearer one counts, so that rounding cannot send the search in circles.
    forEachSharing(surface, cell, best.u, best.v, [&](const SharingCell& other) {
      if (!surface.patch(other.cell, *looked_at) || restsHere(*looked_at, endpoint, other.u, other.v)) return;
      const PatchPoint point = detail::descendPatch(*looked_at, endpoint, other.u, other.v);
      if (point.distance2_mm2 < nearest.distance2_mm2) {
        nearest = point;
        nearest_cell = other.cell;
        std::swap(nearest_patch, looked_at);
      }
    });
    if (nearest_cell == cell) {
      result.end = SearchEnd::kAtRest;
      break;
    }
    cell = nearest_cell;
    std::swap(here, nearest_patch);
    best = nearest;
  }
  result.point = {cell, best.u, best.v, here->at(best.u, best.v), best.distance2_mm2};
  return result;
}

}  // namespace fettle::haptic
