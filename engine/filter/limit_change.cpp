#include "engine/filter/limit_change.h"

#include <cmath>
#include <limits>

namespace fettle::engine {

namespace {

// Largest float <= original + most, most >= 0.
float highest(float original, double most) noexcept {
  const auto x = static_cast<double>(original);
  const double sum = x + most;
  const double virtual_most = sum - x;
  const double error = (x - (sum - virtual_most)) + (most - virtual_most);
  if (sum >= static_cast<double>(std::numeric_limits<float>::max())) return std::numeric_limits<float>::max();
  // The true bound is sum + error, and `error` is less than what one float differs from the next.
  auto bound = static_cast<float>(sum);
  const auto wide = static_cast<double>(bound);
  if (wide > sum || (wide == sum && error < 0.0))
    bound = std::nextafter(bound, -std::numeric_limits<float>::infinity());
  // Only on a thread that flushes denormals, where the next one still counts as zero.
  if (static_cast<double>(bound) > sum) bound = -std::numeric_limits<float>::min();
  return bound;
}

}  // namespace

float limitedChange(float height, float original, double most) noexcept {
  // Rounding is monotonic, so a difference that rounds to less than `most` is less. NaN compares false.
  const double change = static_cast<double>(height) - static_cast<double>(original);
  if (!(std::fabs(change) >= most)) return height;
  if (change > 0.0) {
    const float bound = highest(original, most);
    return height > bound ? bound : height;
  }
  const float bound = -highest(-original, most);
  return height < bound ? bound : height;
}

}  // namespace fettle::engine
