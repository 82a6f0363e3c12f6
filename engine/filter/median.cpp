#include "engine/filter/median.h"

namespace fettle::engine {

float midpoint(float a, float b) noexcept {
  // One rounding to float is all that shows. If the smaller is at least 2^-28 of the larger, their sum fits
  // the 53 bits of a double. If it is less, the mean lies within 2^-28 of half the larger, which is a float,
  // and no tie between floats is that near: whatever the double loses, the float is that half.
  return static_cast<float>((static_cast<double>(a) + static_cast<double>(b)) * 0.5);
}

std::unique_ptr<BlockFilter> makeMedianFilter(const FilterSpec& spec, CpuLevel level) {
  return spec.window <= kSmallMedianWindow ? makeSmallMedian(spec.window, level)
                                           : makeRankMedian(spec.window, level);
}

}  // namespace fettle::engine
