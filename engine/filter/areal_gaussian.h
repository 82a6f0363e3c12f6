#pragma once

#include <cstdint>

#include "engine/filter/pass.h"

namespace fettle::engine {

/// The pass of FilterKind::kArealGaussian (filter.h): FilterPass.
[[nodiscard]] Result<PassResult> arealGaussianPass(const Version& input, const Version& original,
                                                   const FilterSpec& spec, const FilterTuning& tuning,
                                                   JobControl& job);

/// How far a result of arealGaussianPass depends on samples around it, and at what places pieces of a field begin that have
/// the field's results [samples].
[[nodiscard]] std::int32_t arealGaussianReach(const FilterSpec& spec, const Grid& grid) noexcept;
[[nodiscard]] std::int32_t arealGaussianGrid(const FilterSpec& spec, const Grid& grid) noexcept;

}  // namespace fettle::engine
