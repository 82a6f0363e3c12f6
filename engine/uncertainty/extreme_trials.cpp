#include "engine/uncertainty/extreme_trials.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "engine/field/tile.h"

namespace fettle::engine {

namespace {

constexpr double kDown = 10.0;  // of 1e9 samples so far down one in 1e14 trials has one that comes up
constexpr int kClasses = 100;
constexpr std::int64_t kEach = 16;  // drawn one by one

// The height that a normal deviate exceeds with probability p.
double exceededWith(double p) noexcept {
  double low = -10.0, high = 10.0;
  while (high - low > 1e-9) {
    const double middle = 0.5 * (low + high);
    (0.5 * std::erfc(middle / std::numbers::sqrt2) > p ? low : high) = middle;
  }
  return low;
}

// The greatest of n normal deviates: below x with probability (1 - p)^n.
double greatestOf(std::int64_t n, double uniform) noexcept {
  return exceededWith(-std::expm1(std::log(uniform) / static_cast<double>(n)));
}

}  // namespace

ExtremeTail::ExtremeTail(const Version& surface, End end, double sigma) : classes_(kClasses), sigma_(sigma) {
  const FieldReader reader = surface.reader();
  const HeightBounds bounds = reader.bounds();
  if (bounds.empty()) return;
  const double outwards = end == End::kHighest ? 1.0 : -1.0;
  const double extreme = end == End::kHighest ? bounds.max : bounds.min;
  const bool upright = reader.sign() > 0.0F;
  for (std::int32_t tr = 0; tr < reader.tileRows(); ++tr)
    for (std::int32_t tc = 0; tc < reader.tileColumns(); ++tc) {
      const HeightBounds of_tile = reader.entry(tc, tr).bounds;
      const double nearest = end == End::kHighest ? of_tile.max : of_tile.min;
      if (of_tile.empty() || (upright && outwards * (extreme - nearest) >= kDown * sigma)) continue;
      const std::int32_t columns = std::min(kTileSide, reader.width() - tc * kTileSide),
                         rows = std::min(kTileSide, reader.height() - tr * kTileSide);
      float z[kTileSamples];
      reader.readHeights(tc * kTileSide, tr * kTileSide, columns, rows, z, kTileSide);
      for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
          const double down = outwards * (extreme - z[r * kTileSide + c]) / sigma;
          if (!(down < kDown)) continue;  // a hole fails it, too
          const double place = std::max(down, 0.0) / kDown * kClasses;
          HeightClass& of = classes_[std::min(static_cast<std::size_t>(place), classes_.size() - 1)];
          ++of.count;
          of.sum += down;
        }
    }
}

TrialPair ExtremeTail::drawn(std::mt19937_64& random) const {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(std::numeric_limits<double>::min(), 1.0);
  double more = -kDown, less = -kDown;
  bool any = false;
  for (const HeightClass& of : classes_) {
    if (of.count == 0) continue;
    any = true;
    const double down = of.sum / static_cast<double>(of.count);
    if (of.count > kEach) {
      // Of many the greatest and the least are independent.
      more = std::max(more, greatestOf(of.count, uniform(random)) - down);
      less = std::max(less, greatestOf(of.count, uniform(random)) - down);
      continue;
    }
    for (std::int64_t k = 0; k < of.count; ++k) {
      const double noise = normal(random);
      more = std::max(more, noise - down);
      less = std::max(less, -noise - down);
    }
  }
  return any ? TrialPair{more * sigma_, less * sigma_} : TrialPair{};
}

}  // namespace fettle::engine
