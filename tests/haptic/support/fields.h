#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "engine/field/builder.h"
#include "haptic/contact/surface.h"

namespace fettle::tests {

inline constexpr float kHole = std::numeric_limits<float>::quiet_NaN();

/// A field from a function of (column, row) -> height, spacing in mm.
template <class F>
engine::Version fieldOf(std::int32_t width, std::int32_t height, F&& z, double sx = 1.0, double sy = 1.0) {
  engine::Grid grid;
  grid.width = width;
  grid.height = height;
  grid.spacing_x = sx;
  grid.spacing_y = sy;
  std::vector<float> samples;
  for (std::int32_t r = 0; r < height; ++r)
    for (std::int32_t c = 0; c < width; ++c) samples.push_back(static_cast<float>(z(c, r)));
  return engine::makeField(grid, samples);
}

/// One kind of random field a number: gentle, rough, steep, ridges and pits, spikes of 1e6, duplicate
/// heights, each with holes now and then. std::mt19937_64 and plain arithmetic: the same on every machine.
inline engine::Version randomField(std::mt19937_64& random, std::int32_t width, std::int32_t height, int kind,
                                   double sx, double sy, double holes = 0.0) {
  const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  return fieldOf(
      width, height,
      [&](int, int) -> double {
        if (unit() < holes) return std::numeric_limits<double>::quiet_NaN();
        const double x = unit();
        switch (kind % 6) {
          case 0:
            return 0.2 * x;
          case 1:
            return 2.0 * x;
          case 2:
            return 20.0 * x;
          case 3:
            return x < 0.2 ? 5.0 : (x > 0.8 ? -5.0 : 0.0);
          case 4:
            return x < 0.05 ? 1e6 : x;
          default:
            return std::floor(3.0 * x);
        }
      },
      sx, sy);
}

/// A random number in [low, high).
inline double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

/// Squared distance from `e` to the closest point of one patch, in long double, by brute force: for a fixed v
/// the minimum along u is closed form; along v a dense scan, and around each of its low points golden section
/// to the last bits.
inline long double bruteDistance2(const haptic::Patch& s, const glm::dvec3& e) {
  using Real = long double;
  const auto along = [&](Real v) {
    const Real ex = Real(e.x) - s.x0;
    const Real p = s.b + Real(s.d) * v;
    const Real w = Real(s.a) - e.z + s.c * v;
    Real u = (s.sx * ex - w * p) / (Real(s.sx) * s.sx + p * p);
    u = u < 0 ? Real(0) : (u > 1 ? Real(1) : u);
    const Real px = s.sx * u - ex;
    const Real py = s.sy * v - (Real(e.y) - s.y0);
    const Real z = w + p * u;
    return px * px + py * py + z * z;
  };
  // Evenly, and ever closer to both ends: next to a spike all happens within a millionth of an edge.
  std::vector<Real> v;
  for (int i = 0; i <= 200; ++i) v.push_back(Real(i) / 200);
  for (Real near = 0.005L; near > 1e-13L; near *= 0.7L) {
    v.push_back(near);
    v.push_back(1 - near);
  }
  std::sort(v.begin(), v.end());
  std::vector<Real> f;
  for (const Real x : v) f.push_back(along(x));
  const std::size_t last = v.size() - 1;
  Real best = f[0] < f[last] ? f[0] : f[last];
  for (std::size_t i = 0; i <= last; ++i) {
    if ((i > 0 && f[i - 1] < f[i]) || (i < last && f[i + 1] < f[i])) continue;
    Real low = i > 0 ? v[i - 1] : Real(0);
    Real high = i < last ? v[i + 1] : Real(1);
    for (int k = 0; k < 90; ++k) {
      const Real a = low + (high - low) * 0.381966011250105151795L;
      const Real b = high - (high - low) * 0.381966011250105151795L;
      (along(a) < along(b) ? high : low) = along(a) < along(b) ? b : a;
    }
    const Real found = along(0.5L * (low + high));
    best = found < best ? found : best;
  }
  return best;
}

}  // namespace fettle::tests
