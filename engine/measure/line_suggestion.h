#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/measure/line_offsets.h"

namespace fettle::engine {

/// Which way of levelling leaves the lines of a scan closest together, and how close each does.
struct LineSuggestion {
  /// At most so many samples of each line find its offset, and as many others say how far it lies from its neighbours then.
  static constexpr std::int32_t kMostPlaces = 512;
  /// A way whose lines lie at most so many times as far apart as the closest is as good, and the simplest of these is suggested.
  static constexpr double kAsGood = 1.1;

  struct Tried {
    LineMethod method = LineMethod::kMedian;
    int degree = 0;      ///< of kPolynomial
    double apart = 0.0;  ///< [height_unit]
  };
  double before = 0.0;              ///< of the lines as they are [height_unit]
  std::vector<Tried> tried;         ///< the simplest first
  std::optional<std::size_t> best;  ///< nothing: no way brings them closer together by a tenth
  std::int32_t places = 0;          ///< of each line that were looked at, both kinds
  std::int32_t length = 0;          ///< of a line
};

/// Tries all ways along the axis of `options`, with its region and the form that stays. How far lines lie apart is the mean of the size
/// of the median difference between a line and the one 1, 4 and 16 further on: of neighbours alone the differences would be zero by
/// what kDifference is, whose errors add up from line to line, which the farther ones show. By samples that had no part in
/// finding the offsets: what follows noise is not rewarded.
///
/// Cost: some 45 ms for a million samples of those looked at and way on two cores, 1.3 s for 4096 lines (`fettle bench measure`); deterministic. Errors: those of findLineOffsets;
/// fewer than two lines that can be compared (kInput); kCancelled. Thread: any; a long job.
[[nodiscard]] Result<LineSuggestion> suggestLevelling(const Version& field, const LineOptions& options,
                                                      JobControl& job);

}  // namespace fettle::engine
