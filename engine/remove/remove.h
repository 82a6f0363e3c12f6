#pragma once

#include <cstdint>
#include <limits>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/measure/region.h"

namespace fettle::engine {

/// Which samples become holes: those of a region whose height lies in an interval, or outside one.
struct RemoveOptions {
  enum class Heights : std::uint8_t {
    kBetween,  ///< low <= height <= high; without limits any height
    kOutside,  ///< height < low, or height > high
  };
  Heights heights = Heights::kBetween;
  /// [height_unit], with the sign of the field; an infinite one is no limit.
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  /// Marked samples stay unless this names them: kMarked removes them alone, kAll them too.
  Region region = Region::kUnmarked;

  friend bool operator==(const RemoveOptions&, const RemoveOptions&) = default;
};

/// The same samples of the field turned upside down.
[[nodiscard]] inline RemoveOptions upsideDown(RemoveOptions options) noexcept {
  const double low = options.low;
  options.low = -options.high;
  options.high = -low;
  return options;
}

/// Errors (kInput): a limit that is no number, or the lower one above the upper one, where every sample or none would be meant.
[[nodiscard]] Status validate(const RemoveOptions& options);

/// How many samples of a field are chosen.
struct RemoveCounts {
  std::int64_t removed = 0;  ///< samples with such a height in the region
  std::int64_t spared = 0;   ///< with such a height, but marked, and the region is kUnmarked
  std::int64_t heights = 0;  ///< with any height
};
/// Counts them: tiles whose bounds decide are not read. Errors: those of validate; kCancelled. Thread: any.
[[nodiscard]] Result<RemoveCounts> countRemoved(const Version& field, const RemoveOptions& options,
                                                JobControl& job);

/// A field with holes in their place.
struct Removed {
  Version field;
  RemoveCounts counts;
};

/// Makes holes of the chosen samples. A removed sample loses its mark, since nothing is left that it would protect: else its hole would count as
/// marked, and would not be filled. All other samples keep their bits and marks; edge lines, sign and form stay; tiles without a
/// removed sample stay shared.
///
/// Errors: those of validate; every sample would go (kInput), since no surface would be left to work on; kFailed without memory;
/// kCancelled, after a row of tiles. Time: a look at each tile, and the samples of tiles that bounds do not decide. Thread: any.
[[nodiscard]] Result<Removed> removeSamples(const Version& field, const RemoveOptions& options,
                                            JobControl& job);

}  // namespace fettle::engine
