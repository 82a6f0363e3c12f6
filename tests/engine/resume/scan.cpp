#include "tests/engine/resume/scan.h"

#include <cstdint>
#include <limits>
#include <vector>

#include "engine/field/builder.h"
#include "engine/filter/catalogue.h"

namespace fettle::engine {

Version scanWithEverything(std::int32_t width, std::int32_t height, std::uint64_t seed) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  std::vector<float> heights;
  std::vector<std::uint8_t> marks;
  std::uint64_t state = seed;
  for (std::int32_t r = 0; r < height; ++r)
    for (std::int32_t c = 0; c < width; ++c) {
      state = state * 6364136223846793005U + 1442695040888963407U;
      const float noise = static_cast<float>(static_cast<std::int64_t>(state) >> 40) * 0x1p-23F;
      const bool hole = state >> 8 & (c > width / 2 ? 0 : 1) && (c / 9 + r / 7) % 11 == 0;
      heights.push_back(hole ? std::numeric_limits<float>::quiet_NaN()
                             : static_cast<float>((c / 50 + r / 70) % 3) + 0.1F * noise);
      marks.push_back(c > 20 && c < 40 && r > 5 ? 1 : 0);
    }
  return makeField(grid, heights, marks);
}

FilterSpec specFor(FilterKind kind, int passes, int threads) {
  FilterSpec spec;
  spec.kind = kind;
  if (filterOf(kind).window.exists()) spec.window = 5;
  if (hasRange(kind)) spec.range_sigma = 0.1;
  if (separatesScales(filterOf(kind))) spec.nesting_mm = 6.0;
  spec.passes = passes;
  spec.threads = threads;
  return spec;
}

}  // namespace fettle::engine
