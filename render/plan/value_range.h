#pragma once

#include "engine/field/version.h"
#include "render/plan/picture.h"

namespace fettle::render {

/// The values of a field (or of a deviation) for which a picture is planned.
struct ValueSpan {
  /// The range of nearly all values. Each end is the true extreme when that is near, otherwise the percentile
  /// plus a tenth of the span between the percentiles: single spikes do not count. low < high unless all
  /// values are equal.
  ValueRange robust;
  ValueRange extreme;  ///< the true lowest and highest value
  bool empty = true;   ///< no value at all: all holes. The ranges are 0, 0 then.
};

/// Heights, sign applied [height_unit]. Percentiles 0.2 and 99.8 of about a million samples spread evenly
/// over the tiles, the same ones each time; extremes exact from the pyramid.
[[nodiscard]] ValueSpan heightSpan(const engine::Version& field);

/// field - original where both have a sample, in double precision; both of one width and height. Exact
/// extremes; the robust range is symmetric about zero: 99.5th percentile of the absolute value of the
/// deviations that are not zero (unchanged samples do not indicate the size of changes), or the largest when
/// within 1.25 times that. Tiles that the two share are not read.
[[nodiscard]] ValueSpan deviationSpan(const engine::Version& field, const engine::Version& original);

/// The span of the same values with their signs changed. For heights and deviations alike: the result of
/// heightSpan and deviationSpan for inverted fields, except for how a percentile between two samples is
/// rounded.
[[nodiscard]] ValueSpan negated(const ValueSpan& span) noexcept;

/// The smallest span that holds both.
[[nodiscard]] ValueSpan join(const ValueSpan& a, const ValueSpan& b) noexcept;

}  // namespace fettle::render
