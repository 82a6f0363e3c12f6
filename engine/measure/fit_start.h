#pragma once

#include <vector>

#include "engine/measure/fit_samples.h"
#include "engine/measure/fit_shape.h"

namespace fettle::engine {

/// Shapes near to coarse points, the most likely ones first, at most `most`: from normals of small and large windows of the
/// points, all of them and random sixes (R. Schnabel, R. Wahl, R. Klein, Efficient RANSAC for point-cloud shape detection,
/// 2007; H. Pottmann, T. Randrup, Rotational and helical surface approximation for reverse engineering, 1998), ordered by
/// their median distance from the points, so that up to half of these may belong to something else. Deterministic.
[[nodiscard]] std::vector<Shape> likelyShapes(const FitSamples::Coarse& coarse, ShapeKind kind,
                                              std::size_t most);

}  // namespace fettle::engine
