#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "engine/edges/across.h"
#include "engine/edges/chain.h"
#include "engine/edges/strip.h"
#include "engine/edges/surface_fit.h"

namespace fettle::engine {

/// A line as it runs in the strip of a Polyline: at each point, offset and extent of the surfaces on its sides.
struct StripLine {
  std::vector<double> offsets;
  std::vector<double> deviations;
  std::vector<Extent> extents;
};

/// All that fitting the sides of a line reads. References; the caller keeps what they refer to.
struct SideContext {
  const Polyline& line;
  const Strip& strip;
  const SampleWindow& window;
  const std::vector<OffsetRange>& ranges;
  int half = 4;           ///< points before and after whose samples count
  double variance = 0.0;  ///< of the noise [height_unit^2]
};

/// The surfaces left (d above the line) and right of a line at one point, and one plane in place of both.
struct Sides {
  PlaneFit left, right, joined;

  /// Enough samples for both planes.
  [[nodiscard]] bool supported() const noexcept { return left.count >= kLeast && right.count >= kLeast; }
  static constexpr double kLeast = 5.0;
};

/// Calls visit(sample, s, is_left) for the samples beside a line at one point: those at least `guard` from it on either side,
/// within its extent, with s counted from the point.
template <class Visit>
void forEachBeside(const SideContext& context, const StripLine& line, int i, double guard, Visit&& visit) {
  constexpr double kInsideExtent = 0.5;  // of a surface at whose end another begins [samples]
  const auto at = static_cast<std::size_t>(i);
  const Extent extent = line.extents[at];
  forEachKept(context.line, context.strip, context.window, context.ranges, i, context.half,
              [&](const StripSample& sample, double s, int j) {
                // The surfaces' ends run along with the line.
                const double offset = line.offsets[static_cast<std::size_t>(j)];
                const double shift = offset - line.offsets[at];
                if (sample.d < extent.low + std::min(shift, 0.0) + kInsideExtent ||
                    sample.d > extent.high + std::max(shift, 0.0) - kInsideExtent)
                  return;
                if (sample.d > offset + guard)
                  visit(sample, s, true);
                else if (sample.d < offset - guard)
                  visit(sample, s, false);
              });
}

/// Planes of these samples.
[[nodiscard]] Sides sidesAt(const SideContext& context, const StripLine& line, int i, double guard);

/// Moves the line to where the samples next to it change from fitting one surface to fitting the other:
/// surfaces from samples clear of the line; the truncated squared residual of each sample near it against the
/// surface of the side where an offset puts it; a chain along. Twice, nearer to the line the second time.
/// Blocks, on all workers.
void refine(const SideContext& context, StripLine& line);

}  // namespace fettle::engine
