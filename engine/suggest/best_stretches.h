#pragma once

#include <cstddef>
#include <vector>

#include <glm/vec2.hpp>

namespace fettle::engine {

/// How long a hand takes for a stroke.
struct HandPace {
  /// To look at the next place, decide and go there [s]: a key, a thought and a pointing by the keystroke-level
  /// model (S. Card, T. Moran and A. Newell, The keystroke-level model for user performance time with interactive
  /// systems, 1980): 0.2 + 1.35 + 1.1.
  double reach_s = 2.65;
  /// Along the edge [samples/s]: 20 mm/s over a part of 100 mm in 1024 samples. A view is enlarged until samples
  /// can be told apart, so that it is samples that count, whatever the size of the part.
  double samples_per_s = 200.0;

  /// Of a stroke of this length [samples].
  [[nodiscard]] double seconds(double length) const noexcept { return reach_s + length / samples_per_s; }
};

/// A way along which a hand could draw.
struct GainPath {
  std::vector<glm::dvec2> points;  ///< [samples]
  std::vector<double> gains;       ///< what a line gains at each point, in any unit and of any sign; as many
};

/// Points first .. last of a path.
struct WorthStretch {
  std::size_t first = 0, last = 0;
  double gain = 0.0;     ///< sum of the points' gains, > 0
  double length = 0.0;   ///< [samples]
  double seconds = 0.0;  ///< of the pace
};

/// Divides a path into strokes worth drawing: the stretch with the most gain per second, then that of what is left on
/// either side of it, and so on. Each is at least `shortest` [samples] long, and none overlaps another. Most gain per
/// second by W. Dinkelbach, On nonlinear fractional programming (1967): the largest gain less a price for the
/// seconds, at the price that makes it zero. In the order in which they are found. O(n) for each stretch and step.
[[nodiscard]] std::vector<WorthStretch> bestStretches(const GainPath& path, const HandPace& pace,
                                                      double shortest);

}  // namespace fettle::engine
