#pragma once

#include "engine/filter/pass.h"

namespace fettle::engine {

/// The passes of FilterKind::kSpline and kRobustSpline (filter.h): FilterPass.
[[nodiscard]] Result<PassResult> splinePass(const Version& input, const Version& original,
                                            const FilterSpec& spec, const FilterTuning& tuning,
                                            JobControl& job);
[[nodiscard]] Result<PassResult> robustSplinePass(const Version& input, const Version& original,
                                                  const FilterSpec& spec, const FilterTuning& tuning,
                                                  JobControl& job);

/// Where samples lack or weigh less the surface is found step by step, until the root mean square of all errors is about this
/// share of the heights' standard deviation about their plane, or of the limit of the weights; after 1,000 steps at most.
inline constexpr double kSplineTolerance = 2e-9;

}  // namespace fettle::engine
