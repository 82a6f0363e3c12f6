#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/error.h"
#include "engine/measure/roughness.h"
#include "engine/uncertainty/noise_trial.h"

namespace fettle::engine {

/// What noise does to the roughness of a section, a row for each of roughnessInfos(); NaN also of Rc that noise changes by more than 3 %, or whose elements' width RSm it
/// changes by more than 2 % or leaves open by as much, where its error would be larger than what there
/// is of heights and shares of the material ratio curve, and all of these of waviness; all by withinRange().
using RoughnessNoise = std::vector<NoiseEffect>;

/// By trials (noise_trial.h) in which heights of the section get noise with the covariance that independent noise of standard deviation
/// `noise_mm` in every sample gives them (Section::covariance), drawn through its banded Cholesky factor. `found` is roughnessOf(section, within,
/// filters). Noise that samples share is left out, as in the errors of section_figures.h. `noise_mm` not above 0: no effect, NaN.
/// Time: 2 pairs times that of roughnessOf, and places times band squared. Errors: those of roughnessOf. Thread: any.
[[nodiscard]] Result<RoughnessNoise> roughnessNoise(const Section& section, const Stretch& within,
                                                    const ProfileFilters& filters, const Roughness& found,
                                                    double noise_mm, const NoiseTrialOptions& options);

/// Heights with such noise, `sign` times; places without a height have none. For tests.
[[nodiscard]] std::vector<double> sectionNoise(const Section& section, double noise_mm, std::uint64_t seed);

}  // namespace fettle::engine
