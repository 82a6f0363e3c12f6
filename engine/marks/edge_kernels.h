#pragma once

#include <vector>

namespace fettle::engine {

/// Gaussian of `sigma` samples and its first two derivatives, sampled at the integers of -radius .. radius,
/// as weights for sum(w[radius + d] * z(x + d)). Exact for what they measure: the smoothing keeps a constant,
/// the first derivative of a line and the second of a parabola come out right, and each gives nothing for
/// all that is lower in degree.
struct EdgeKernels {
  int radius = 0;
  std::vector<float> smooth, first, second;
};
[[nodiscard]] EdgeKernels edgeKernels(double sigma);

}  // namespace fettle::engine
