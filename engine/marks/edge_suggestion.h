#pragma once

#include <cstdint>
#include <vector>

#include "engine/marks/change_marks.h"
#include "engine/marks/edge_response.h"

namespace fettle::engine {

// Suggests which samples of a noisy scan lie on the part's sharp edges, for a person to accept or to correct.
//
//   field --median, derivatives--> step, crease --/ noise--> strength --thinned--> EdgeMap
//   EdgeMap --hysteresis, length--> lines --thickened--> marks
//
// The first part takes most of the time and depends on the scale alone; the second is fast, so that the
// suggestion follows a slider for the sensitivity.
//
// Noise need not be given: the strength of a sample is its response over the standard deviation that noise
// gives it, and that is measured on the field itself, by the median of absolute values, so that nearly half
// of the samples may lie on edges (Hampel, The Influence Curve, 1974, section 5).

/// A sample at which the edge response is a maximum across the edge.
struct EdgeCandidate {
  std::int32_t column = 0;
  std::int32_t row = 0;
  float strength = 0.0F;  ///< standard deviations of noise, >= EdgeMap::kLeastStrength
};

struct EdgeMap {
  static constexpr double kUsualSigma = 1.5;
  static constexpr float kLeastStrength = 2.0F;

  double sigma = 0.0;  ///< of the search [samples]
  std::vector<EdgeCandidate> candidates;
  /// Standard deviation of noise: the unit of the strength [height unit per sample; per square sample].
  double step_noise = 0.0;
  double crease_noise = 0.0;
};

/// Finds edges whose surroundings are flat or smooth over about 2 sigma: a small sigma separates edges that
/// are near each other, a large one finds weaker ones. `sigma` in samples, EdgeResponse::kSmallestSigma ..
/// kLargestSigma.
///
/// Progress counts samples, a cancel takes effect within about 50 ms. Blocks on all workers of the calling
/// arena; bit-identical for any thread count. The sign of the field does not matter. Memory: a buffer per
/// thread and the candidates, about 3 % of the samples. Errors: sigma out of range (kInput), cancelled,
/// memory.
[[nodiscard]] Result<EdgeMap> findEdges(const Version& field, double sigma, JobControl& job);

/// Which edges to mark.
struct EdgeChoice {
  /// 0 .. 1: how strong a line must be at one of its samples, see strength(). The line continues down to half
  /// of that.
  double sensitivity = 0.5;
  double thickness = 1.0;  ///< marked to this distance of the line [samples], 0 .. 64
  /// Lines of fewer samples are left out, 1 ..; 0: four sigma of the search.
  int shortest = 0;

  /// 32 standard deviations at sensitivity 0, 8 at 0.5, 2 at 1; exponential in between.
  [[nodiscard]] double strength() const noexcept;
};

struct EdgeSuggestion {
  Version field;             ///< the input with the suggested marks added
  std::int64_t lines = 0;    ///< connected pieces
  std::int64_t samples = 0;  ///< on them, before they are thickened
};

/// Marks the edges of `map` that `choice` takes, on top of the marks there are; holes are not marked. `field`
/// has the size that `map` was found on. Hysteresis as in Canny (1986), section VII: a whole line is taken
/// when one of its samples is strong enough; samples up to 2 columns and rows apart belong to one line, since
/// thinning leaves gaps where directions are rounded. Errors: a choice out of range (kInput), cancelled,
/// memory.
[[nodiscard]] Result<EdgeSuggestion> suggestMarks(const Version& field, const EdgeMap& map,
                                                  const EdgeChoice& choice, JobControl& job);

}  // namespace fettle::engine
