#include "engine/inspect/height_counts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace fettle::engine {

namespace {

constexpr std::int32_t kTaken = 128;       // along each side
constexpr double kMostOff = 0.2;           // of a step, from a whole number of them
constexpr double kLeastOfRounding = 64.0;  // a step against the rounding of the largest height

// Evenly spread heights, sorted.
std::vector<double> spreadHeights(const Version& field) {
  const FieldReader reader = field.reader();
  std::vector<double> heights;
  const std::int32_t columns = std::min(kTaken, reader.width()), rows = std::min(kTaken, reader.height());
  for (std::int32_t r = 0; r < rows; ++r)
    for (std::int32_t c = 0; c < columns; ++c) {
      const auto at = [](std::int64_t i, std::int64_t n, std::int64_t of) {
        return static_cast<std::int32_t>((2 * i + 1) * of / (2 * n));
      };
      const float z = reader.heightAt(at(c, columns, reader.width()), at(r, rows, reader.height()));
      if (z == z) heights.push_back(static_cast<double>(z));
    }
  std::ranges::sort(heights);
  return heights;
}

}  // namespace

double HeightCounts::nearest(double height) const noexcept {
  return step > 0.0 ? first + step * std::nearbyint((height - first) / step) : height;
}

HeightCounts findHeightCounts(const Version& field) {
  const std::vector<double> heights = spreadHeights(field);
  if (heights.size() < 2) return {};
  const double first = heights.front();
  const double rounding = std::ldexp(std::max(std::abs(first), std::abs(heights.back())), -23);
  double step = heights.back() - first;
  for (std::size_t i = 1; i < heights.size(); ++i)
    if (const double apart = heights[i] - heights[i - 1]; apart > 4.0 * rounding)
      step = std::min(step, apart);
  if (!(step > kLeastOfRounding * rounding)) return {};
  // From near to far, so that the step is known the better the more of them are counted.
  std::size_t off = 0;
  for (const double z : heights) {
    const double steps = (z - first) / step, whole = std::nearbyint(steps);
    if (std::abs(steps - whole) > kMostOff)
      ++off;
    else if (whole > 0.0)
      step = (z - first) / whole;
  }
  if (off > heights.size() / 1000) return {};
  return {step, first};
}

}  // namespace fettle::engine
