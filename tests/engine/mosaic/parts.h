#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "engine/field/builder.h"
#include "engine/measure/rigid_motion.h"

namespace fettle::engine {

/// A part with hills of several sizes, everywhere [mm].
inline double hillsAt(double x, double y) {
  return 0.4 * std::sin(0.9 * x + 0.3) * std::cos(0.7 * y) + 0.25 * std::sin(1.7 * x - 1.3 * y + 1.0) +
         0.15 * std::cos(2.9 * y + 0.04 * x * x) + 0.1 * std::sin(3.1 * x + 0.03 * y * y);
}

inline Grid gridFor(std::int32_t width, std::int32_t height, double sx, double sy) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  grid.spacing_x = sx;
  grid.spacing_y = sy;
  return grid;
}

/// The height of the part, moved, over a place of a scan: by bisection, without the product's code [mm].
inline double movedHills(const RigidMotion& motion, double x, double y) {
  double low = motion.shift.z - 50.0, high = motion.shift.z + 50.0;
  for (int round = 0; round < 60; ++round) {
    const double middle = 0.5 * (low + high);
    const glm::dvec3 p = motion.movedBack({x, y, middle});
    (p.z > hillsAt(p.x, p.y) ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

/// A scan of the part, moved from the part's coordinates to the scan's, with noise and damage.
inline Version scanOfHills(const Grid& grid, const RigidMotion& motion, double noise, std::uint64_t seed,
                           const std::function<double(int, int, double)>& damage = {}) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<float> heights;
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) {
      double z = movedHills(motion, c * grid.spacingXMm(), r * grid.spacingYMm()) + noise * normal(random);
      if (damage) z = damage(c, r, z);
      heights.push_back(static_cast<float>(z / grid.height_unit.mm));
    }
  return makeField(grid, heights);
}

}  // namespace fettle::engine
