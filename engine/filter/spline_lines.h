#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/job.h"
#include "engine/simd/cpu.h"

namespace fettle::engine {

/// The linear spline filter of a line of equally spaced samples: of all lines w the one of least
///
///     sum of (z - w)^2  +  a^4 * sum of (w[i - 1] - 2 w[i] + w[i + 1])^2,      a = 1 / (2 sin(pi / L)),
///
/// L the cut-off in samples: (I + a^4 Q) w = z with natural ends (M. Krystek, Form filtering by splines, 1996; ISO 16610-22). A
/// wave of length l keeps 1 / (1 + (sin(pi / l) / sin(pi / L))^4) of its amplitude, half at L; a straight line comes back.
///
/// Solving these equations loses a^4 in digits: at L = 1600 one in 10^6. Here z - w is found from what each sample is away from
/// the prediction by those before it, forth and back: the Kalman filter of the model whose most likely line w is, and the
/// smoother of P. de Jong (Smoothing and interpolation with the state-space model, 1989). Their error is a few a * 2^-53
/// of the heights.
struct SplineAxis {
  /// Of a cut-off of at least 2 samples, for lines of so many.
  SplineAxis(double cut_off, std::int32_t samples);

  std::int32_t samples = 0;
  double step = 1.0;  ///< what a slope of the prediction is divided by from sample to sample
  /// Of each sample from the third one on: what a distance from the prediction adds to height and slope, and over its variance.
  std::vector<double> to_height, to_slope, over_variance;
};

/// Heights of a field in double, row-major without gaps.
struct SplinePlane {
  std::int32_t width = 0, height = 0;
  std::vector<double> z;

  [[nodiscard]] double* row(std::int32_t r) noexcept { return z.data() + std::ptrdiff_t{r} * width; }
  [[nodiscard]] const double* row(std::int32_t r) const noexcept {
    return z.data() + std::ptrdiff_t{r} * width;
  }
};

/// The tensor product of the filters of both axes, in place: along all rows, then along all columns. On all workers of the arena; the same
/// bits for any number of them. False when cancelled. Memory: 256 bytes per worker and sample of a line. Throws std::bad_alloc.
[[nodiscard]] bool smoothPlane(const SplineAxis& x, const SplineAxis& y, SplinePlane& plane, CpuLevel level,
                               const JobControl& job);

}  // namespace fettle::engine
