#pragma once

#include <array>
#include <cstdint>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/measure/line_offsets.h"

namespace fettle::engine {

/// How many lines further on the line lies with which one is compared. Of neighbours alone little is seen of what levelling does to
/// blocks of lines, where a part of the surface moves all of a block, and of errors that add up from line to line.
inline constexpr std::array<std::int32_t, 3> kLineLags{1, 4, 16};

/// How far lines of a scan that are `lag` apart lie from each other: the mean over them of the size of the median difference between
/// their samples [height_unit]. Of a line scanner that is off from line to line that is most of it; of a part that is alike on two
/// lines it is nothing, whatever its shape along them.
struct LinesApart {
  /// Levelling that makes it so many times larger moved parts of the surface and no lines. Where there are stripes it becomes two
  /// to four times smaller; where there are none, methods that go from line to line leave it within 1.8 times of what it was, and
  /// medians and means of whole lines, of which parts of the surface take changing shares, make it 3 to 35 times larger (scans of
  /// four instruments).
  static constexpr double kWorse = 2.0;
  /// The same of lines farther apart: where lines were level, errors of 16 medians of noise add up to 2.4 times of what one is.
  static constexpr double kWorseFarther = 4.0;

  std::int32_t lag =
      1;  ///< that of kLineLags at which levelling makes it the most times larger; 1 where it does at none
  double before = 0.0;
  double after = 0.0;  ///< with what is taken from each line
  double least = 0.0;  ///< what rounding of heights as floats may be
  [[nodiscard]] bool worse() const noexcept {
    return after > (lag == 1 ? kWorse : kWorseFarther) * before && after > least;
  }
};

/// By at most 1023 samples of each line, evenly spread. Cost: one pass over those for each lag on one thread; deterministic. Errors:
/// kCancelled.
/// Thread: any.
[[nodiscard]] Result<LinesApart> linesApart(const Version& field, const LineOffsets& offsets,
                                            JobControl& job);

}  // namespace fettle::engine
