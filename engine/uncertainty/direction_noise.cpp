#include "engine/uncertainty/direction_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/uncertainty/part_effects.h"

namespace fettle::engine {

namespace {

constexpr double kNoDirection = std::numeric_limits<double>::quiet_NaN();
constexpr double kMostDegrees = 10.0;

double turnBetween(double degrees, double other) noexcept {
  const double away = degrees - other;
  return away - 180.0 * std::round(away / 180.0);
}

// Without noise of so much of the mean square.
double without(const SeenDirection& seen, double square) noexcept {
  return seen.mean_square > 0.0 ? seen.spatial.layWithout(square / seen.mean_square) : kNoDirection;
}

}  // namespace

SeenDirection seenDirection(const ArealParameters& measured) {
  return {measured.sq * measured.sq, measured.spatial};
}

NoiseEffect directionEffect(const SeenDirection& found, const SeenDirection& of_part,
                            std::span<const DirectionPair> pairs, const NoiseModel& noise, double share) {
  if (std::isnan(found.spatial.lay)) return {kNoDirection, kNoDirection};
  // What the trials add, which filters may have left of it.
  double more = 0.0;
  for (const DirectionPair& pair : pairs)
    more += 0.5 * (pair.more.mean_square + pair.less.mean_square) / static_cast<double>(pairs.size());
  const double added = std::max(0.0, more - of_part.mean_square) * noise.uncorrelatedShare();
  std::vector<TrialPair> directions;
  directions.reserve(pairs.size());
  const double of_own = without(of_part, added);
  for (const DirectionPair& pair : pairs) {
    directions.push_back({without(pair.more, 2.0 * added), without(pair.less, 2.0 * added)});
    for (const double degrees : {directions.back().more, directions.back().less})
      if (!(std::abs(turnBetween(degrees, of_own)) <= kMostDegrees))
        return {kNoDirection, kNoDirection, "noise decides which direction is the strongest"};
  }
  NoiseEffect effect = partEffectOf(without(found, added), of_own, directions, NoiseGrowth::kAxis, share);
  if (std::isnan(effect.without)) return effect;
  for (const double other : {added * (1.0 - noise.doubt), added * (1.0 + noise.doubt)}) {
    const double moved = turnBetween(without(found, other), without(found, added));
    effect.error = std::hypot(effect.error, moved);
  }
  if (!(effect.error <= kMostDegrees))
    return {kNoDirection, kNoDirection, "noise decides which direction is the strongest"};
  return effect;
}

}  // namespace fettle::engine
