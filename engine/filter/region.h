#pragma once

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/sample_rect.h"
#include "engine/field/version.h"
#include "engine/filter/filter.h"

namespace fettle::engine {

/// `onto` with the tiles of `range` (cut to the field) as applyFilter of the whole `input` has them,
/// bit-identical; all others as `onto` has them. The three versions are of one grid and memory. Time in proportion to
/// the range and as much around it as the filter reaches. Errors, progress, threads as applyFilter.
[[nodiscard]] Result<Version> filterRange(const Version& input, const Version& original, const Version& onto,
                                          const FilterSpec& spec, TileRange range, JobControl& job);

}  // namespace fettle::engine
