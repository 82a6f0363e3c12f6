#pragma once

#include <cstdint>
#include <vector>

#include "engine/field/version.h"

namespace fettle::bench {

/// A whole field as one array of doubles, row by row; without holes.
struct Plane {
  std::int32_t width = 0, height = 0;
  std::vector<double> z;

  [[nodiscard]] double& at(std::int32_t c, std::int32_t r) {
    return z[static_cast<std::size_t>(r) * static_cast<std::size_t>(width) + static_cast<std::size_t>(c)];
  }
  [[nodiscard]] double at(std::int32_t c, std::int32_t r) const {
    return z[static_cast<std::size_t>(r) * static_cast<std::size_t>(width) + static_cast<std::size_t>(c)];
  }
};

[[nodiscard]] inline Plane planeOf(const engine::Version& field) {
  const engine::FieldReader reader = field.reader();
  Plane plane{reader.width(), reader.height(), {}};
  std::vector<float> line(static_cast<std::size_t>(plane.width));
  for (std::int32_t r = 0; r < plane.height; ++r) {
    reader.readHeights(0, r, plane.width, 1, line.data(), plane.width);
    plane.z.insert(plane.z.end(), line.begin(), line.end());
  }
  return plane;
}

}  // namespace fettle::bench
