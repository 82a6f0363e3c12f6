#include "engine/marks/edge_kernels.h"

#include <cmath>
#include <cstddef>

namespace fettle::engine {

EdgeKernels edgeKernels(double sigma) {
  EdgeKernels kernels;
  // Beyond 3.5 sigma there is 0.05 % of the weight.
  kernels.radius = static_cast<int>(std::ceil(3.5 * sigma));
  const auto taps = static_cast<std::size_t>(2 * kernels.radius + 1);
  std::vector<double> g(taps);
  double sum = 0.0, squares = 0.0, fourth = 0.0;
  for (std::size_t i = 0; i < taps; ++i) {
    const double d = static_cast<double>(i) - kernels.radius;
    g[i] = std::exp(-0.5 * d * d / (sigma * sigma));
    sum += g[i];
  }
  for (std::size_t i = 0; i < taps; ++i) {
    const double d = static_cast<double>(i) - kernels.radius;
    g[i] /= sum;
    squares += d * d * g[i];
    fourth += d * d * d * d * g[i];
  }
  kernels.smooth.resize(taps);
  kernels.first.resize(taps);
  kernels.second.resize(taps);
  for (std::size_t i = 0; i < taps; ++i) {
    const double d = static_cast<double>(i) - kernels.radius;
    kernels.smooth[i] = static_cast<float>(g[i]);
    kernels.first[i] = static_cast<float>(d * g[i] / squares);
    // (d^2 - <d^2>) g has no constant part; times d^2 / 2 it sums to (<d^4> - <d^2>^2) / 2.
    kernels.second[i] = static_cast<float>(2.0 * (d * d - squares) * g[i] / (fourth - squares * squares));
  }
  return kernels;
}

}  // namespace fettle::engine
