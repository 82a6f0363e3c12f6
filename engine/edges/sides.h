#pragma once

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

/// Planes of the samples at least `guard` from the line on either side, within its extent.
[[nodiscard]] Sides sidesAt(const SideContext& context, const StripLine& line, int i, double guard);

/// Moves the line to where the samples next to it change from fitting one surface to fitting the other:
/// surfaces from samples clear of the line; the truncated squared residual of each sample near it against the
/// surface of the side where an offset puts it; a chain along. Twice, nearer to the line the second time.
/// Blocks, on all workers.
void refine(const SideContext& context, StripLine& line);

}  // namespace fettle::engine
