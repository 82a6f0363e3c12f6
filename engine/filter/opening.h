#pragma once

#include <cstdint>

#include "engine/filter/pass.h"

namespace fettle::engine {

/// The passes of FilterKind::kOpening and kClosing (filter.h): FilterPass.
[[nodiscard]] Result<PassResult> openingPass(const Version& input, const Version& original,
                                             const FilterSpec& spec, const FilterTuning& tuning,
                                             JobControl& job);
[[nodiscard]] Result<PassResult> closingPass(const Version& input, const Version& original,
                                             const FilterSpec& spec, const FilterTuning& tuning,
                                             JobControl& job);

/// How far a result depends on samples around it, whatever their heights [samples].
[[nodiscard]] std::int32_t openingReach(const FilterSpec& spec, const Grid& grid) noexcept;

/// An element that reaches farther than this from its middle is rolled over the whole field at once [samples].
inline constexpr std::int32_t kMostReachInBlocks = 128;

}  // namespace fettle::engine
