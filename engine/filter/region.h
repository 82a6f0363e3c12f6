#pragma once

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/tile_range.h"
#include "engine/field/version.h"
#include "engine/filter/filter.h"

namespace fettle::engine {

/// How far a filter's result depends on samples around it [samples].
[[nodiscard]] constexpr std::int32_t reachOf(const FilterSpec& spec) noexcept {
  return spec.passes * (spec.window / 2);
}

/// `onto` with the tiles of `range` (cut to the field) as applyFilter of the whole `input` has them, to the
/// bit; all others as `onto` has them. The three versions are of one grid and memory. Time in proportion to
/// the range and as much around it as the filter reaches. Errors, progress, threads as applyFilter.
[[nodiscard]] Result<Version> filterRange(const Version& input, const Version& original, const Version& onto,
                                          const FilterSpec& spec, TileRange range, JobControl& job);

}  // namespace fettle::engine
