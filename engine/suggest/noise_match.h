#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/suggest/sample_zones.h"

namespace fettle::engine {

/// By how much noise has to be larger than the model of it says, on flats and near edges, so that a filter takes off a
/// synthetic sample what it takes off the scan.
struct NoiseMatch {
  double flat = 1.0, edge = 1.0;  ///< 1 / kMostMatched .. kMostMatched

  /// In a zone; between flats and edges the mean.
  [[nodiscard]] double in(SampleZone zone) const noexcept;
};

/// Noise is known to some 5 % (NoiseModel). What is missing further is not noise: a filter takes off a scan parts of its
/// texture, too.
inline constexpr double kMostMatched = 1.08;

/// Compares what total variation takes off `scan` and off `sample`, a synthetic scan of the same size made of it, both
/// with noise of `sigma` [height_unit, > 0]. The model measures noise in windows that show no edge, spread over the
/// field; where noise follows the depth, places near edges have other noise than these.
///
///   scan   - tv(scan)    rms in each zone
///   ------------------------------------- = match
///   sample - tv(sample)
///
/// More than 6 sigma is no noise and is left out; so are holes of either. A zone of less than kFewestMatched samples has 1.
/// Errors: cancelled; memory (kFailed). Throws std::bad_alloc. Any thread, on all workers.
[[nodiscard]] Result<NoiseMatch> matchNoise(const Version& scan, const Version& sample,
                                            const std::vector<SampleZone>& zones, double sigma,
                                            JobControl& job);

inline constexpr std::int64_t kFewestMatched = 1000;

}  // namespace fettle::engine
