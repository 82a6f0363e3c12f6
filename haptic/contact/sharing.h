#pragma once

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
template <class F>
void forEachSharing(const Surface& surface, CellIndex cell, double u, double v, F&& f) noexcept {
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

}  // namespace fettle::haptic
