#pragma once

#include <vector>

namespace fettle::engine {

/// Gaussian of `sigma` samples and its first two derivatives, sampled at the integers of -radius .. radius,
/// as weights for sum(w[radius + d] * z(x + d)). Exact on polynomials: the smoothing keeps a constant, the
/// first derivative of a line and the second of a parabola are exact, and each derivative is 0 for lower
/// degrees.
struct EdgeKernels {
  int radius = 0;
  std::vector<float> smooth, first, second;
};
[[nodiscard]] EdgeKernels edgeKernels(double sigma);

}  // namespace fettle::engine
