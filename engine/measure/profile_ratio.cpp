#include "engine/measure/profile_ratio.h"

#include <algorithm>
#include <cstddef>

namespace fettle::engine {

double materialRatioAt(std::span<const double> profile, double height) noexcept {
  double length = 0.0;
  for (std::size_t i = 1; i < profile.size(); ++i) {
    const auto [low, high] = std::minmax(profile[i - 1], profile[i]);
    if (low >= height)
      length += 1.0;
    else if (high > height)
      length += (high - height) / (high - low);
  }
  return length / static_cast<double>(profile.size() - 1);
}

double heightOfRatio(std::span<const double> profile, double ratio) noexcept {
  auto [low, high] = std::ranges::minmax(profile);
  // By lengths a single highest place has the ratio 0.
  if (materialRatioAt(profile, high) >= ratio) return high;
  constexpr int kHalvings = 48;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (low + high);
    (materialRatioAt(profile, middle) >= ratio ? low : high) = middle;
  }
  return low;
}

}  // namespace fettle::engine
