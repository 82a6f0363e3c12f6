#pragma once

#include <vector>

#include "engine/base/job.h"
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
  double share = 1.0;  ///< of the deviations that are not zero, those within the robust range, 0 .. 1
};

/// Heights, sign applied [height_unit]. Percentiles 0.2 and 99.8 of about a million samples spread evenly
/// over the tiles, the same ones each time; extremes exact from the pyramid.
[[nodiscard]] ValueSpan heightSpan(const engine::Version& field);

/// field - original where both have a sample, in double precision; both of one width and height. Exact
/// extremes; the robust range is symmetric about zero, of the absolute value of the deviations that are not
/// zero (unchanged samples do not indicate the size of changes): up to the 99.5th percentile, but not beyond
/// kUsualChanges times the median, which noise stays below and a few samples at an edge do not move; or up to
/// the largest when within 1.25 times that. Tiles that the two share are not read.
[[nodiscard]] ValueSpan deviationSpan(const engine::Version& field, const engine::Version& original);

/// Values of a field (or of a deviation) for choosing the range of the colours: how often each occurs.
struct ValueSample {
  std::vector<double>
      sorted;  ///< ascending, about a million, four of each tile where those are more [height_unit]; of a deviation those not 0
  ValueRange extreme;  ///< as ValueSpan

  [[nodiscard]] bool empty() const noexcept { return sorted.empty(); }
  /// The value below which `share` (0 .. 1) of them lie. Not empty.
  [[nodiscard]] double quantile(double share) const noexcept;
  /// Share of them that lie within [low, high].
  [[nodiscard]] double within(double low, double high) const noexcept;
  /// The range that holds the middle `share` of them; symmetric about zero for a deviation. Not empty.
  [[nodiscard]] ValueRange middle(double share) const noexcept;
  [[nodiscard]] ValueRange symmetric(double share) const noexcept;
};

/// The same samples as those of heightSpan and deviationSpan. Any thread. Cancelled, that of a deviation lacks some.
[[nodiscard]] ValueSample heightSample(const engine::Version& field);
[[nodiscard]] ValueSample deviationSample(const engine::Version& field, const engine::Version& original,
                                          const engine::JobControl* job = nullptr);

/// The span of the same values with their signs changed. For heights and deviations alike: the result of
/// heightSpan and deviationSpan for inverted fields, except for how a percentile between two samples is
/// rounded.
[[nodiscard]] ValueSpan negated(const ValueSpan& span) noexcept;

/// The smallest span that holds both.
[[nodiscard]] ValueSpan join(const ValueSpan& a, const ValueSpan& b) noexcept;

}  // namespace fettle::render
