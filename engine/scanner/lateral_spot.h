#pragma once

#include <functional>

#include "engine/scanner/laser_effects.h"

namespace fettle::engine {

/// Fine samples per sample along each axis, of which the heights under the spot are averaged: the place of a wall in
/// the scan is exact to half of one, 0.07 samples.
inline constexpr int kSpotFineness = 7;

/// What the scanner measures through a spot of light: the mean height under a Gaussian of standard deviation `spot`
/// [samples, > 0], cut at three of them, which rounds walls and creases. Through holes reflect nothing: what remains of
/// the spot counts, and a sample in a hole stays one. `height(column, row)`: of the true surface, at any place [mm].
/// The lateral resolution of triangulation: Curless and Levoy 1995 (laser_effects.h), section 2.
void averageUnderSpot(ScanBlock& block, double spot, const std::function<double(double, double)>& height);

}  // namespace fettle::engine
