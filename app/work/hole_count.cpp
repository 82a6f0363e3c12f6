#include "app/work/hole_count.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace fettle::app {

std::int64_t holesIn(const engine::Version& field) {
  const engine::FieldReader reader = field.reader();
  constexpr std::int32_t kSide = engine::kTileSide;
  std::vector<float> heights(static_cast<std::size_t>(kSide) * kSide);
  std::int64_t holes = 0;
  for (std::int32_t tr = 0; tr < reader.tileRows(); ++tr)
    for (std::int32_t tc = 0; tc < reader.tileColumns(); ++tc) {
      if (!reader.entry(tc, tr).holed) continue;
      const std::int32_t columns = std::min(kSide, reader.width() - tc * kSide),
                         rows = std::min(kSide, reader.height() - tr * kSide);
      reader.readHeights(tc * kSide, tr * kSide, columns, rows, heights.data(), columns);
      holes += std::count_if(heights.begin(), heights.begin() + static_cast<std::ptrdiff_t>(columns) * rows,
                             [](float z) { return std::isnan(z); });
    }
  return holes;
}

}  // namespace fettle::app
