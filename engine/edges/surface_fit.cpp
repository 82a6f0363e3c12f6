#include "engine/edges/surface_fit.h"

#include <algorithm>
#include <cstddef>

namespace fettle::engine {

PlaneFit fitPlane(const Moments& m) noexcept {
  PlaneFit fit;
  if (m.n < 0.5) return fit;
  fit.count = m.n;
  fit.centre_d = m.d / m.n;
  fit.centre_s = m.s / m.n;
  fit.height = m.z / m.n;
  const double zz = m.zz - m.z * fit.height;
  fit.residual = std::max(0.0, zz);
  if (m.n < kLeastForPlane) return fit;
  const double dd = m.dd - m.d * fit.centre_d + kLevelling;
  const double ss = m.ss - m.s * fit.centre_s + kLevelling;
  const double ds = m.ds - m.d * fit.centre_s;
  const double zd = m.zd - m.z * fit.centre_d;
  const double zs = m.zs - m.z * fit.centre_s;
  const double determinant = dd * ss - ds * ds;
  fit.inverse_dd = ss / determinant;
  fit.inverse_ss = dd / determinant;
  fit.inverse_ds = -ds / determinant;
  fit.slope_d = (zd * ss - zs * ds) / determinant;
  fit.slope_s = (zs * dd - zd * ds) / determinant;
  fit.residual = std::max(0.0, zz - fit.slope_d * zd - fit.slope_s * zs);
  return fit;
}

double hingeResidual(const Moments& before, const Moments& after, double at) noexcept {
  // z = a + b d + c s + e max(0, d - at): normal equations, by elimination.
  const Moments all = before + after;
  const double h = after.d - at * after.n;
  const double hd = after.dd - at * after.d;
  const double hs = after.ds - at * after.s;
  const double hh = hd - at * h;
  const double zh = after.zd - at * after.z;
  constexpr std::size_t kUnknowns = 4;
  double rows[kUnknowns][kUnknowns + 1] = {{all.n + kLevelling, all.d, all.s, h, all.z},
                                           {all.d, all.dd + kLevelling, all.ds, hd, all.zd},
                                           {all.s, all.ds, all.ss + kLevelling, hs, all.zs},
                                           {h, hd, hs, hh + kLevelling, zh}};
  const double right[kUnknowns] = {all.z, all.zd, all.zs, zh};
  for (std::size_t i = 0; i < kUnknowns; ++i)
    for (std::size_t j = i + 1; j < kUnknowns; ++j) {
      const double factor = rows[j][i] / rows[i][i];
      for (std::size_t c = i; c <= kUnknowns; ++c) rows[j][c] -= factor * rows[i][c];
    }
  double solution[kUnknowns];
  double residual = all.zz;
  for (std::size_t i = kUnknowns; i-- > 0;) {
    double x = rows[i][kUnknowns];
    for (std::size_t c = i + 1; c < kUnknowns; ++c) x -= rows[i][c] * solution[c];
    solution[i] = x / rows[i][i];
    residual -= solution[i] * right[i];
  }
  return std::max(0.0, residual);
}

}  // namespace fettle::engine
