#pragma once

#include <cmath>
#include <cstdint>

namespace fettle::engine {

/// Between which means of `step` samples a sample lies (meansOf), along one axis, and how far it is from the first to the second.
struct BetweenMeans {
  std::int32_t cell = 0, next = 0;
  float share = 0.0F;
};

/// `sample` counts from the first one of the first of `cells` means.
[[nodiscard]] inline BetweenMeans betweenMeans(std::int32_t sample, std::int32_t step,
                                               std::int32_t cells) noexcept {
  const double x = (sample + 0.5) / step - 0.5;
  const auto cell = static_cast<std::int32_t>(std::floor(x));
  if (cell < 0) return {0, 0, 0.0F};
  if (cell >= cells - 1) return {cells - 1, cells - 1, 0.0F};
  return {cell, cell + 1, static_cast<float>(x - cell)};
}

/// Between two heights, of which a hole does not count.
[[nodiscard]] inline float heightBetween(float a, float b, float share) noexcept {
  const float mean = a + share * (b - a);
  return a != a ? b : b != b ? a : mean;
}

}  // namespace fettle::engine
