#pragma once

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/filter/filter.h"

namespace fettle::engine {

/// The range sigma of a filter in standard deviations of the scan's noise that left the least error over the
/// whole of simulated bracket, wedges, steps and die (384 x 384, noise 1 and 3): 0.41 of the scan's own for
/// both. Half as much leaves a tenth more, twice as much takes a tenth more off the edges.
inline constexpr double kBilateralNoises = 4.0;
inline constexpr double kTotalVariationNoises = 1.0;

/// The spec with a range sigma: its own when it has one or needs none, else so many sigmas of the noise that
/// estimateNoise finds in `field`. A spec to be applied in parts or again later is given its range first: a
/// part has a noise of its own. Errors: no noise to be seen in the field (kInput), cancelled. As
/// estimateNoise otherwise.
[[nodiscard]] Result<FilterSpec> withMeasuredRange(const FilterSpec& spec, const Version& field,
                                                   JobControl& job);

}  // namespace fettle::engine
