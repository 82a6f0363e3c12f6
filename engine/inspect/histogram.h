#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// Number of samples by height. Bin i of n counts the heights h with
///   low + i (high - low) / n <= h < low + (i + 1) (high - low) / n,   the last one those at `high`, too.
struct HeightHistogram {
  double low = 0.0, high = 0.0;      ///< lowest and highest sample [height_unit]; NaN without samples
  std::vector<std::int64_t> counts;  ///< one per bin; holes are not counted

  [[nodiscard]] double lowEnd(int bin) const noexcept {
    return low + (high - low) * bin / static_cast<double>(counts.size());
  }
};

inline constexpr int kMostBins = 4096;

/// `bins` 1 .. kMostBins. The same for any number of threads. If all samples are equal they are in the first
/// bin. Errors: kInput for bins out of range, kCancelled. Thread: any, on all workers of the calling arena.
[[nodiscard]] Result<HeightHistogram> countHeights(const Version& field, int bins, JobControl& job);

}  // namespace fettle::engine
