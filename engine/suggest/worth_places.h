#pragma once

#include <cstddef>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/suggest/best_stretches.h"

namespace fettle::engine {

// Where a line drawn by hand would bring generalised variation (FilterKind::kGeneralisedVariation) nearest to the
// truth, for the time that it takes. On strong, clean edges the filter finds them itself and a line gains nothing; on
// edges about as high as the noise, and where scanners leave samples between two surfaces, it gains a lot.

struct WorthRequest {
  /// Pieces of 448 x 448 samples that are looked at, at most: those with the most edges.
  static constexpr std::size_t kMostPieces = 64;

  double noise =
      0.0;  ///< standard deviation of the field's noise [height_unit], > 0; estimateNoise() measures it
  HandPace pace;
  std::size_t most = 200;  ///< places at most, >= 1
  int threads = 0;         ///< as FilterSpec::threads
};

/// A place for one stroke.
struct WorthPlace {
  std::vector<glm::dvec2> path;  ///< where an edge probably runs [samples], in drawing order
  double length = 0.0;           ///< of the stroke [samples]
  /// By how much a line would probably lower the sum of squared errors over the field [height_unit^2], > 0.
  double gain = 0.0;
  double seconds = 0.0;  ///< that it takes, WorthRequest::pace
};

struct WorthPlaces {
  std::vector<WorthPlace> places;  ///< the most gain per second first
  double samples = 0.0;            ///< of the field that are not holes
  std::size_t left_out = 0;        ///< pieces with edges beyond kMostPieces, in which no place was sought
  /// Sum of squared errors that the filter probably leaves without the lines [height_unit^2]: too small where it misses
  /// edges that the search misses as well. Its root was 0.26 to 1.4 of the
  /// true one on simulated scans, least on ribs: an order of places, not a figure to rely on.
  double left = 0.0;

  /// Root mean square error over the field that is expected after the first `count` places [height_unit].
  [[nodiscard]] double rmseAfter(std::size_t count) const noexcept;
};

/// Searches for the places where a line by hand is worth most, besides the edge lines that the field has.
///
///   field --edges (findEdges), traced, continued over gaps, located--> lines
///   lines --tried with and without them (tryLines)--> gain along each --divided (bestStretches)--> places
///
/// What was tried and measured: docs/decisions/worth-places.md.
///
/// Result: no places where nothing is to be gained; none gains less than 0.1 % of `left`. Holes are left out.
/// Bit-identical for any number of threads. Time: findEdges() of the whole field, then up to kMostPieces pieces:
/// locateEdgeLines() of their edges, and four runs of the filter. Progress: several stages; a cancel takes effect
/// within half a second. Errors: noise that is not positive and finite
/// (kInput), cancelled, memory (kFailed). Thread: any; blocks, on request.threads workers.
[[nodiscard]] Result<WorthPlaces> findWorthPlaces(const Version& field, const WorthRequest& request,
                                                  JobControl& job);

}  // namespace fettle::engine
