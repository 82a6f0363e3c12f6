#pragma once

#include "bench/accuracy/plane.h"

namespace fettle::bench {

// Faster approximate filters from the literature, to measure their error. No holes, no marks; windows shrink
// at borders unless stated otherwise. One thread, plain loops.

/// Separable Gaussian, weights and sums in float.
[[nodiscard]] Plane gaussianInFloat(const Plane& in, double sigma, int radius);

/// Recursive Gaussian of third order, forwards and back: Young and van Vliet, Recursive implementation of the
/// Gaussian filter (1995). Borders are held constant. sigma >= 0.5.
[[nodiscard]] Plane gaussianRecursive(const Plane& in, double sigma);

/// Median of rows, then of columns of the result, called separable median. `radius` samples each way.
[[nodiscard]] Plane medianSeparable(const Plane& in, int radius);

/// Median of heights rounded to `levels` steps between lowest and highest, by a histogram that slides along
/// each row: Huang, Yang and Tang, A fast two-dimensional median filtering algorithm (1979). Lower median.
[[nodiscard]] Plane medianOfLevels(const Plane& in, int radius, int levels);

}  // namespace fettle::bench
