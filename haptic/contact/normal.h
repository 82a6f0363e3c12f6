#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "haptic/contact/surface.h"

namespace fettle::haptic {

/// A cell that shares a surface point, and the point's parameters in it.
struct SharingCell {
  CellIndex cell;
  double u, v;
};

/// Calls f(SharingCell) for the OTHER cells of the field that share the point: none for an interior point,
/// one for an edge, three for a vertex, fewer at the border. Holes are not tested for. Order: across u,
/// across v, across both.
void forEachSharing(const Surface& surface, CellIndex cell, double u, double v, auto&& f) noexcept {
  const int across_u = u == 0.0 ? -1 : (u == 1.0 ? 1 : 0);
  const int across_v = v == 0.0 ? -1 : (v == 1.0 ? 1 : 0);
  const auto visit = [&](int du, int dv) {
    const CellIndex other{cell.column + du, cell.row + dv};
    if (surface.hasCell(other)) f(SharingCell{other, du == 0 ? u : 1.0 - u, dv == 0 ? v : 1.0 - v});
  };
  if (across_u != 0) visit(across_u, 0);
  if (across_v != 0) visit(0, across_v);
  if (across_u != 0 && across_v != 0) visit(across_u, across_v);
}

/// Unit normal of a patch, z > 0.
[[nodiscard]] inline glm::dvec3 patchNormal(const Patch& patch, double u, double v) noexcept {
  const double slope_x = (patch.b + patch.d * v) / patch.sx;
  const double slope_y = (patch.c + patch.d * u) / patch.sy;
  const double length = std::sqrt(slope_x * slope_x + slope_y * slope_y + 1.0);
  return {-slope_x / length, -slope_y / length, 1.0 / length};
}

/// The surface's normal at a point, and of how many cells it is the mean.
struct SurfaceNormal {
  glm::dvec3 direction{0.0, 0.0, 1.0};  ///< unit length, z > 0
  int cells = 0;  ///< 1 inside a cell, 2 on an edge, up to 4 at a vertex; holes left out
};

/// Mean of the unit normals of the cells that share the point, holes left out. `point` is on a cell without
/// holes. Source: Potter, Johnson, Cohen, DETC2004-57539, "Haptic Rendering".
[[nodiscard]] inline SurfaceNormal surfaceNormal(Surface& surface, const SurfacePoint& point) noexcept {
  SurfaceNormal normal;
  Patch patch;
  if (!surface.patch(point.cell, patch)) return normal;
  glm::dvec3 sum = patchNormal(patch, point.u, point.v);
  normal.cells = 1;
  forEachSharing(surface, point.cell, point.u, point.v, [&](const SharingCell& other) {
    if (!surface.patch(other.cell, patch)) return;
    sum += patchNormal(patch, other.u, other.v);
    ++normal.cells;
  });
  // Every summand has z > 0, so the sum is never zero.
  normal.direction = normal.cells == 1 ? sum : glm::normalize(sum);
  return normal;
}

}  // namespace fettle::haptic
