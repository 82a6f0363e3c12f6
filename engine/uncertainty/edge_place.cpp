#include "engine/uncertainty/edge_place.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "engine/scanner/counter_random.h"

namespace fettle::engine {

namespace {

// The variance of a sum of many places over that of as many independent ones.
double sharedByPlaces(const Section& section) {
  const auto band = static_cast<std::size_t>(section.band);
  double own = 0.0, all = 0.0;
  for (std::size_t i = 0; i < section.size(); ++i) {
    own += section.covariance[i * band];
    all += section.covariance[i * band];
    for (std::size_t k = 1; k < band; ++k) all += 2.0 * section.covariance[i * band + k];
  }
  return own > 0.0 ? std::max(1.0, all / own) : 1.0;
}

// The mean square, in places, of where such walks to both sides are highest.
double meanSquareOfPlaces(double step_over_noise, std::int32_t most_places) {
  constexpr std::int32_t kWalks = 4096;
  const CounterRandom random(1, 0);
  const double fall = 0.5 * step_over_noise * step_over_noise;
  // After so many places a walk has fallen by eight of its standard deviations.
  const auto length =
      static_cast<std::int32_t>(std::min(most_places + 0.0, std::ceil(1.0 + 64.0 / (0.5 * fall))));
  double squares = 0.0;
  for (std::int32_t walk = 0; walk < kWalks; ++walk) {
    double highest = 0.0, place = 0.0;
    for (const int side : {0, 1}) {
      double at = 0.0;
      for (std::int32_t m = 1; m <= length; ++m) {
        at += step_over_noise * random.normal(2 * walk + side, m) - fall;
        if (at > highest) {
          highest = at;
          place = m;
        }
      }
    }
    squares += place * place;
  }
  return squares / kWalks;
}

}  // namespace

double edgeError(const Section& section, const StepFigures& step) {
  const double free = step.places - 3.0;
  const double rms = free > 0.0 ? step.rms_mm * std::sqrt(step.places / free) : step.rms_mm;
  const double noise = rms * std::sqrt(sharedByPlaces(section)), size = std::abs(step.step_mm.value);
  // Below it the step's own error, whose fourth power the walk's places follow, leaves the spread open.
  constexpr double kLeast = 3.5;
  if (!(size > kLeast * noise)) return std::numeric_limits<double>::quiet_NaN();
  // Beyond ten no place changes sides.
  constexpr double kSure = 10.0;
  const double of_noise = size < kSure * noise
                              ? meanSquareOfPlaces(size / noise, static_cast<std::int32_t>(section.size()))
                              : 0.0;
  return section.step_mm * std::sqrt(1.0 / 12.0 + of_noise);
}

}  // namespace fettle::engine
