#include "engine/filter/middle_height.h"

#include <algorithm>
#include <cstddef>

namespace fettle::engine {

double middleHeight(const Block& block, std::vector<float>& scratch, int step) {
  scratch.clear();
  for (int r = 0; r < block.rows; r += step)
    for (int c = 0; c < block.columns; c += step)
      if (block.row(r)[c] == block.row(r)[c]) scratch.push_back(block.row(r)[c]);
  if (scratch.empty()) return step > 1 ? middleHeight(block, scratch, 1) : 0.0;
  const auto high = scratch.begin() + static_cast<std::ptrdiff_t>(scratch.size() / 2);
  std::nth_element(scratch.begin(), high, scratch.end());
  const float low = scratch.size() % 2 == 1 ? *high : *std::max_element(scratch.begin(), high);
  return 0.5 * (static_cast<double>(low) + static_cast<double>(*high));
}

}  // namespace fettle::engine
