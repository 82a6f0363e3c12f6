#include "engine/filter/median.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace fettle::engine {

float midpoint(float a, float b) noexcept {
  const auto x = static_cast<double>(a);
  const auto y = static_cast<double>(b);
  double sum = x + y;
  // Heights more than 29 binary orders apart do not fit one double. Then the sum is taken to the neighbour
  // with an odd last bit, which a second rounding to fewer bits cannot mistake for a tie (S. Boldo,
  // G. Melquiond, Emulation of a FMA and correctly rounded sums: proved algorithms using rounding to odd,
  // 2008).
  const double virtual_y = sum - x;
  const double error = (x - (sum - virtual_y)) + (y - virtual_y);
  if (error != 0.0 && (std::bit_cast<std::uint64_t>(sum) & 1U) == 0) {
    constexpr double kInf = std::numeric_limits<double>::infinity();
    sum = std::nextafter(sum, error > 0.0 ? kInf : -kInf);
  }
  return static_cast<float>(sum * 0.5);
}

std::unique_ptr<BlockFilter> makeMedianFilter(const FilterSpec& spec) {
  return spec.window <= kSmallMedianWindow ? makeSmallMedian(spec.window) : makeRankMedian(spec.window);
}

}  // namespace fettle::engine
