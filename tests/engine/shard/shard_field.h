#pragma once

#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "engine/field/builder.h"

namespace fettle::tests {

/// Steps, slopes and noise, with single holes, a hole of several tiles, spikes of 1e6 and a flat part.
inline engine::Version hardField(int width, int height) {
  engine::Grid grid;
  grid.width = width;
  grid.height = height;
  grid.spacing_x = 0.5;
  grid.spacing_y = 2.0;
  grid.origin_x = 5e6 + 0.25;
  std::mt19937 random(22);
  std::vector<float> z;
  std::vector<std::uint8_t> marks;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) {
      float height_here = 0.01F * static_cast<float>(c) + (r / 90 % 2 == 0 ? 0.0F : 1.0F) +
                          1e-3F * static_cast<float>(random() % 100);
      if (r > height / 3 && r < height / 3 + 70 && c < width / 2) height_here = 2.0F;
      if (random() % 60 == 0 || (r > 120 && r < 200 && c > width * 2 / 3))
        height_here = std::numeric_limits<float>::quiet_NaN();
      if (random() % 500 == 0) height_here = 1e6F;
      z.push_back(height_here);
      marks.push_back(random() % 30 == 0);
    }
  return engine::makeField(grid, z, marks);
}

}  // namespace fettle::tests
