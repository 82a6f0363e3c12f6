#pragma once

#include <span>

#include "engine/inspect/noise_model.h"
#include "engine/measure/areal.h"
#include "engine/uncertainty/noise_trial.h"

namespace fettle::engine {

/// Of a measurement what Std without noise is taken of.
struct SeenDirection {
  double mean_square = 0.0;  ///< Sq squared
  SpatialParameters spatial;
};
[[nodiscard]] SeenDirection seenDirection(const ArealParameters& measured);
struct DirectionPair {
  SeenDirection more, less;  ///< with a noise, and with its opposite
};

/// Std without noise, and its error. Noise that neighbours do not share lifts the angular spectrum alike in all directions, so that peaks beside the
/// largest reach half of its height; more noise does not show what none is. So the spectrum is taken less what the noise has in it, which is as much of the mean
/// square as the trials add, and twice that in theirs: SpatialParameters::layWithout(). Of these directions the effect is that of
/// partEffectOf() (of_part: found itself where trials are on the whole, `share` 1), and the error counts how far the direction goes where the noise is another by its
/// doubt. No value where a trial is, or the error, more than 10 degrees: then noise decides which of several directions is the strongest.
[[nodiscard]] NoiseEffect directionEffect(const SeenDirection& found, const SeenDirection& of_part,
                                          std::span<const DirectionPair> pairs, const NoiseModel& noise,
                                          double share);

}  // namespace fettle::engine
