#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/mosaic/pose_adjustment.h"

namespace fettle::engine {

/// The height where several scans have one.
enum class Blend : std::uint8_t {
  kFade,   ///< weights by the distance to each scan's rim: no step where a scan ends
  kMean,   ///< the mean of all
  kFirst,  ///< that of the first of them
};

/// What two scans differ by where both have heights, at up to 65,536 places spread over their overlap. Lengths in mm.
struct OverlapDeviation {
  std::size_t first = 0, second = 0;
  std::int64_t places = 0;
  double median = 0.0, mean = 0.0, rms = 0.0;  ///< height of the second less that of the first
  double spread = 0.0;                         ///< 1.4826 times the median distance from the median
  double height_error =
      0.0;  ///< standard error of the height of one over the other in the middle, by the poses
};

/// Of every two scans that have at least 12 such places. Thread: any; on all workers of the calling arena. Errors: kCancelled.
/// Throws std::bad_alloc.
[[nodiscard]] Result<std::vector<OverlapDeviation>> overlapDeviations(const std::vector<Version>& scans,
                                                                      const AdjustedPoses& poses,
                                                                      JobControl& job);

/// The grid of the first scan's samples, continued over all scans. Errors (kInput): more than Grid::kMaxSide a side.
[[nodiscard]] Result<Grid> gridOverAll(const std::vector<Version>& scans, const AdjustedPoses& poses);

/// All scans at the samples of a grid of gridOverAll(): bilinear between their samples, blended, in its height unit, rounded to
/// float once. Where a scan has a hole the others count; a hole where none has a height. A sample is marked where the nearest
/// one of a scan that counts there is. No edge lines. Tile by tile: nothing but the result is held, which may lie in a
/// store. Errors: kFailed without memory; kCancelled. Thread: any; a long job on all workers of the calling arena; bit-identical for any
/// number of them.
[[nodiscard]] Result<Version> blendedScans(const std::vector<Version>& scans, const AdjustedPoses& poses,
                                           const Grid& grid, Blend blend, JobControl& job);

}  // namespace fettle::engine
