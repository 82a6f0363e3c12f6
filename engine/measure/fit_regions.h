#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/edge_line.h"
#include "engine/field/version.h"
#include "engine/measure/region.h"

namespace fettle::engine {

/// Samples [column, column + columns) of a row.
struct SampleRun {
  std::int32_t row = 0, column = 0, columns = 0;
};

/// Samples of one surface: runs by row, then column.
struct FitRegion {
  std::vector<SampleRun> runs;
  std::int64_t samples = 0;
};

struct FitRegionOptions {
  Region region = Region::kAll;
  double margin = 2.0;       ///< samples this near to a line belong to no region [samples], at least 1
  std::int64_t least = 100;  ///< regions of fewer samples are left out
};

/// What lies between edge lines: samples of the options' region that are connected along rows and columns, not across the
/// margin around a line, whether a point of it was located or is that of the hand. A margin also closes a gap of a line that
/// is narrower than twice as wide. The largest region first, of equal ones the one with the first sample.
///
/// Memory: 12 bytes for each run of samples. Errors: kCancelled. Throws std::bad_alloc. Thread: any; a job on this one.
[[nodiscard]] Result<std::vector<FitRegion>> regionsBetween(const Version& field,
                                                            std::span<const EdgeLine> lines,
                                                            const FitRegionOptions& options, JobControl& job);

/// All samples of the options' region as one, connected or not; without any lines. Errors and thread as regionsBetween.
[[nodiscard]] Result<FitRegion> wholeRegion(const Version& field, Region region, JobControl& job);

/// The region that holds the sample nearest to a place [samples]; its index, or -1.
[[nodiscard]] int regionAt(std::span<const FitRegion> regions, const glm::dvec2& place) noexcept;

}  // namespace fettle::engine
