#pragma once

#include <cstdint>
#include <vector>

#include "engine/marks/change_marks.h"
#include "engine/marks/edge_response.h"

namespace fettle::engine {

// Which samples of a noisy scan lie on the part's sharp edges, for a person to accept or to paint over.
//
//   field --median, derivatives--> step, crease --/ noise--> strength --thinned--> EdgeMap
//   EdgeMap --hysteresis, length--> lines --thickened--> marks
//
// The first half takes the time and depends on the scale alone; the second takes a moment, so that a slider
// for the sensitivity can be moved with the suggestion in view.
//
// Noise is not asked for: the strength of a sample is its response over the standard deviation that noise
// gives it, and that is measured on the field itself, by the median of absolute values, so that nearly half
// of the samples may lie on edges (Hampel, The Influence Curve, 1974, section 5).

/// A place where the surface looks most like an edge, of those beside it across the edge.
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
  /// Standard deviation of noise: the unit of the strength [height unit a sample; and a square sample].
  double step_noise = 0.0;
  double crease_noise = 0.0;
};

/// Looks for edges whose surroundings are flat or smooth over some 2 sigma: a small sigma separates edges
/// that are near each other, a large one finds fainter ones. `sigma` in samples, EdgeResponse::kSmallestSigma
/// .. kLargestSigma.
///
/// Progress counts samples, a cancel is seen within some 50 ms. Blocks on all workers of the calling arena;
/// same bits for any thread count. Heights count with either sign alike. Memory: a scratch a thread and the
/// candidates, some 3 % of the samples. Errors: sigma out of range (kInput), cancelled, memory.
[[nodiscard]] Result<EdgeMap> findEdges(const Version& field, double sigma, JobControl& job);

/// What of it to mark.
struct EdgeChoice {
  /// 0 .. 1: how far a line has to stand out of the noise somewhere, see strength(). It goes on down to half
  /// of that.
  double sensitivity = 0.5;
  double thickness = 1.0;  ///< marked to this distance of the line [samples], 0 .. 64
  /// Lines of fewer samples are left out, 1 ..; 0: four sigma of the search.
  int shortest = 0;

  /// 32 standard deviations at sensitivity 0, 8 at 0.5, 2 at 1; by a factor from tenth to tenth.
  [[nodiscard]] double strength() const noexcept;
};

struct EdgeSuggestion {
  Version field;             ///< as given, with the suggested marks added
  std::int64_t lines = 0;    ///< connected pieces
  std::int64_t samples = 0;  ///< on them, before they are made thick
};

/// Marks the edges of `map` that `choice` takes, on top of the marks there are; holes are not marked. `field`
/// has the size that `map` was found on. Hysteresis as in Canny (1986), section VII: a line is taken whole
/// when one of its samples is strong enough; samples up to 2 columns and rows apart are of one line, since
/// thinning leaves gaps where directions are rounded. Errors: a choice out of range (kInput), cancelled,
/// memory.
[[nodiscard]] Result<EdgeSuggestion> suggestMarks(const Version& field, const EdgeMap& map,
                                                  const EdgeChoice& choice, JobControl& job);

}  // namespace fettle::engine
