#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "engine/field/builder.h"
#include "engine/measure/surface.h"

namespace fettle::engine {

/// A field, or a surface as parameters are measured of it, from heights by column and row; NaN is a hole.
inline Version fieldOf(std::int32_t width, std::int32_t height, const std::function<double(int, int)>& z,
                       const std::function<bool(int, int)>& marked = {}) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  std::vector<float> heights;
  std::vector<std::uint8_t> marks;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) {
      heights.push_back(static_cast<float>(z(c, r)));
      if (marked) marks.push_back(marked(c, r) ? 1 : 0);
    }
  return makeField(grid, heights, marks);
}

inline Surface surfaceOf(std::int32_t width, std::int32_t height, const std::function<double(int, int)>& z) {
  Surface surface;
  surface.width = width;
  surface.height = height;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) {
      surface.heights.push_back(static_cast<float>(z(c, r)));
      if (!std::isnan(surface.heights.back())) ++surface.samples;
    }
  return surface;
}

}  // namespace fettle::engine
