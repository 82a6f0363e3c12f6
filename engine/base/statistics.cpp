#include "engine/base/statistics.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <numeric>

namespace fettle::engine {

ErrorSummary errorSummary(std::vector<double> errors) {
  if (errors.empty()) return {};
  std::sort(errors.begin(), errors.end());
  const auto rank = static_cast<std::size_t>(std::ceil(0.99 * static_cast<double>(errors.size())));
  return {std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(errors.size()),
          errors[std::max<std::size_t>(rank, 1) - 1], errors.back()};
}

TimeSpread timeSpread(std::vector<double> times) {
  assert(!times.empty());
  std::sort(times.begin(), times.end());
  return {times[times.size() / 2], times.back()};
}

std::uint64_t hashOf(std::span<const double> values) {
  std::uint64_t h = 14695981039346656037ULL;
  for (const double value : values) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (int i = 0; i < 64; i += 8) h = (h ^ (bits >> i & 0xff)) * 1099511628211ULL;
  }
  return h;
}

}  // namespace fettle::engine
