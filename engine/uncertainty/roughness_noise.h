#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/error.h"
#include "engine/measure/roughness.h"
#include "engine/measure/section_noise.h"
#include "engine/uncertainty/noise_trial.h"

namespace fettle::engine {

/// What noise does to the roughness of a section, a row for each of roughnessInfos(), then of each Rmr(c) and each Rdc that was asked for; NaN also of Rc that noise changes by more than 3 %, or whose elements' width RSm it
/// changes by more than 2 % or leaves open by as much, where its error would be larger than what there
/// is of heights and shares of the material ratio curve, and all of these of waviness; all by withinRange().
using RoughnessNoise = std::vector<NoiseEffect>;

/// By trials (noise_trial.h) in which heights of the section get noise like its own: with the covariance that independent noise in every
/// sample gives them (Section::covariance), drawn through its banded Cholesky factor, and with what an offset of each row and each column of
/// the field does to them (Section::offBy): one along a row has one offset, which no profile has, one across the rows another at each
/// place, and a width does not make it less. `found` is roughnessOf(section, within, filters, asked). Noise that samples share otherwise is left
/// out, as in the errors of section_figures.h. The noise of samples not above 0 and that of lines neither, or that of samples NaN: no effect, NaN.
/// Time: 2 pairs times that of roughnessOf, places times band squared, and pairs times lanes of all places where lines are off. Errors: those of roughnessOf. Thread: any.
[[nodiscard]] Result<RoughnessNoise> roughnessNoise(const Section& section, const Stretch& within,
                                                    const ProfileFilters& filters, const Roughness& found,
                                                    const SectionNoise& noise,
                                                    const NoiseTrialOptions& options,
                                                    const AskedRatios& asked = {});

/// What such noise adds to the heights, a draw for each seed from `seed` on; places without a height have none. For tests.
[[nodiscard]] std::vector<std::vector<double>> sectionNoise(const Section& section, const SectionNoise& noise,
                                                            std::uint64_t seed, int draws);

}  // namespace fettle::engine
