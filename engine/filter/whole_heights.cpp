#include "engine/filter/whole_heights.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

namespace fettle::engine {

bool WholeHeights::take(const Block& block, std::int64_t count) {
  // All magnitudes are below 2^top, all sums below 2^(top + bits).
  int top = 0;
  (void)std::frexp(block.magnitude, &top);
  const auto bits = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(count)));
  exponent_ = std::min(63 - top - bits, 126);
  if (exponent_ < 0) return false;
  const double power = std::ldexp(1.0, exponent_);
  columns_ = block.columns;
  heights_.resize(static_cast<std::size_t>(block.columns) * static_cast<std::size_t>(block.rows));
  std::int64_t* out = heights_.data();
  for (int r = 0; r < block.rows; ++r) {
    const float* const in = block.row(r);
    bool fit = true;
    for (int c = 0; c < block.columns; ++c) {
      const double scaled = std::isnan(in[c]) ? 0.0 : power * static_cast<double>(in[c]);
      *out = static_cast<std::int64_t>(scaled);
      fit &= static_cast<double>(*out++) == scaled;
    }
    if (!fit) return false;
  }
  return true;
}

float WholeHeights::mean(std::int64_t sum, int count) const noexcept {
  return static_cast<float>(static_cast<double>(sum) / std::ldexp(static_cast<double>(count), exponent_));
}

}  // namespace fettle::engine
