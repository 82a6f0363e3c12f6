#include "bench/plain_search.h"

#include "haptic/contact/patch.h"

namespace fettle::bench {

using haptic::CellIndex;
using haptic::PatchPoint;

PlainSearch::PlainSearch(const engine::Version& field) : heights_(field) {}

glm::dvec3 PlainSearch::tick(const glm::dvec3& e, double stiffness) noexcept {
  const double x = e.x / heights_.spacing_x_mm;
  const double y = e.y / heights_.spacing_y_mm;
  if (!(x >= 0.0 && y >= 0.0 && x < heights_.width - 1 && y < heights_.height - 1)) {
    touching_ = false;
    return glm::dvec3(0.0);
  }
  if (!touching_) {
    cell_ = {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
    u_ = x - cell_.column;
    v_ = y - cell_.row;
    if (!(e.z < heights_.patch(cell_).heightAt(u_, v_))) return glm::dvec3(0.0);
  }
  PatchPoint best = closestOnPatch(heights_.patch(cell_), e, u_, v_);
  for (bool moved = true; moved;) {
    moved = false;
    PatchPoint nearest = best;
    CellIndex nearest_cell = cell_;
    const int across_u = best.u == 0.0 ? -1 : (best.u == 1.0 ? 1 : 0);
    const int across_v = best.v == 0.0 ? -1 : (best.v == 1.0 ? 1 : 0);
    for (int k = 1; k < 4; ++k) {
      const int du = (k & 1) != 0 ? across_u : 0;
      const int dv = (k & 2) != 0 ? across_v : 0;
      if (((k & 1) != 0 && du == 0) || ((k & 2) != 0 && dv == 0)) continue;
      const CellIndex other{cell_.column + du, cell_.row + dv};
      if (other.column < 0 || other.row < 0 || other.column >= heights_.width - 1 ||
          other.row >= heights_.height - 1)
        continue;
      const PatchPoint p = closestOnPatch(heights_.patch(other), e, du == 0 ? best.u : 1.0 - best.u,
                                          dv == 0 ? best.v : 1.0 - best.v);
      if (!(p.distance2_mm2 < nearest.distance2_mm2)) continue;
      nearest = p;
      nearest_cell = other;
      moved = true;
    }
    best = nearest;
    cell_ = nearest_cell;
  }
  u_ = best.u;
  v_ = best.v;
  const glm::dvec3 penetration = heights_.patch(cell_).at(u_, v_) - e;
  touching_ = penetration.z > 0.0;
  return touching_ ? stiffness * penetration : glm::dvec3(0.0);
}

}  // namespace fettle::bench
