#pragma once

#include <cstdint>

#include "engine/filter/pass.h"

namespace fettle::engine {

/// The passes of FilterKind::kArealGaussian and kRobustGaussian (filter.h): FilterPass.
[[nodiscard]] Result<PassResult> arealGaussianPass(const Version& input, const Version& original,
                                                   const FilterSpec& spec, const FilterTuning& tuning,
                                                   JobControl& job);
[[nodiscard]] Result<PassResult> robustGaussianPass(const Version& input, const Version& original,
                                                    const FilterSpec& spec, const FilterTuning& tuning,
                                                    JobControl& job);

/// How far a result of arealGaussianPass depends on samples around it, and at what places pieces of a field begin that have
/// the field's results [samples].
[[nodiscard]] std::int32_t arealGaussianReach(const FilterSpec& spec, const Grid& grid) noexcept;
[[nodiscard]] std::int32_t arealGaussianGrid(const FilterSpec& spec, const Grid& grid) noexcept;

/// The robust filter's weights end at so many medians of the distances: three standard deviations of normal ones are
/// 4.4478 medians, 3 / 0.6745.
inline constexpr double kRobustLimit = 4.4478;
/// Its rounds end where the limit changes by less than this share of itself, and after so many.
inline constexpr double kRobustTolerance = 1e-4;
inline constexpr int kMostRobustRounds = 50;

}  // namespace fettle::engine
