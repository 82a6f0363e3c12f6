#pragma once

#include <vector>

#include "engine/compare/compare.h"
#include "engine/compare/tile_sums.h"

namespace fettle::engine {

// Edge width: the distance over which the height rises at a wall that is vertical in truth.
//
// The method is that of the slanted edge of ISO 12233:2017, annex D (edge spread function), on heights:
//  1. In every 16 x 16 cell, the marked sample next to the largest jump of the truth is the centre of a
//  patch.
//  2. Around it, the truth is cut at half the jump into high and low; the points between different neighbours
//  lie on the edge. Their main axis is the edge's direction, a parabola along it models its curvature.
//     Points off the parabola by more than a sample: a corner, no profile.
//  3. Every sample of the patch gets its distance to the parabola. A plane is fitted to the truth on either
//     side; where the truth is off its plane by more than a tenth of the step there is another edge in reach:
//     no profile. (A crease has no step and ends here too.)
//  4. Each height, less the low plane and divided by the step, is put into bins of half a sample by distance.
//     The bin means are the profile: 10 to 30 samples in each, so noise falls to about a fifth.
//  5. The profile is made monotone (pool adjacent violators: Ayer, Brunk, Ewing, Reid and Silverman, An
//     empirical distribution function for sampling with incomplete information, 1955), which noise is not and
//     a blurred wall is; the width lies between its 10 % and 90 % points, linearly interpolated.

/// Result of one patch [mm].
struct EdgeWidth {
  double truth = 0.0;
  double field = 0.0;  ///< NaN: the field does not span 10 to 90 % within reach
};

/// The profiles whose centres lie in `rect`, in a fixed order. Patches in which a fifth or more of the
/// field's samples are holes are left out. `field`, `truth` and `edges` have one size; field heights are
/// multiplied by `field_in_truth`.
[[nodiscard]] std::vector<EdgeWidth> edgeWidths(const FieldReader& field, double field_in_truth,
                                                const FieldReader& truth, const FieldReader& edges,
                                                const TruthOptions& options, const SampleRect& rect);

}  // namespace fettle::engine
