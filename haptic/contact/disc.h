#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

namespace fettle::haptic {

/// The samples within a radius of a centre sample, distance counted in samples: row by row, offset dr from
/// -reach to reach, columns -half_width[dr + reach] to +half_width[dr + reach].
struct Disc {
  std::int32_t reach = 0;
  std::vector<std::int32_t> half_width;

  /// `radius` [samples] >= 0; a sample exactly at the radius is inside.
  explicit Disc(double radius) : reach(static_cast<std::int32_t>(std::floor(radius))) {
    for (std::int32_t dr = -reach; dr <= reach; ++dr) {
      std::int32_t half = 0;
      while (static_cast<double>((half + 1) * (half + 1) + dr * dr) <= radius * radius) ++half;
      half_width.push_back(half);
    }
  }
};

}  // namespace fettle::haptic
