#pragma once

#include <functional>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/field/builder.h"
#include "engine/scanner/counter_random.h"

namespace fettle::engine {

/// A field of heights z(column, row).
inline Version edgeField(int width, int height, const std::function<double(int, int)>& z) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  std::vector<float> heights;
  heights.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) heights.push_back(static_cast<float>(z(c, r)));
  return makeField(grid, heights);
}

/// White noise of standard deviation 1 at a sample.
inline double whiteNoise(int column, int row, std::uint64_t seed = 1) {
  return CounterRandom(seed, 7).normal(column, row);
}

/// Points one sample apart from one end to the other.
inline std::vector<glm::dvec2> straightStroke(glm::dvec2 from, glm::dvec2 to) {
  const int pieces = static_cast<int>(std::ceil(std::hypot(to.x - from.x, to.y - from.y)));
  std::vector<glm::dvec2> points;
  for (int i = 0; i <= pieces; ++i) points.push_back(from + (to - from) * (static_cast<double>(i) / pieces));
  return points;
}

}  // namespace fettle::engine
