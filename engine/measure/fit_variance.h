#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "engine/measure/fit.h"

namespace fettle::engine {

/// Variances of N figures of a fitted shape, to first order in the covariance of its numbers. `figuresOf` gives the figures of
/// a shape as std::array<double, N>. NaN where the fit states no covariance.
template <std::size_t N, class Figures>
[[nodiscard]] std::array<double, N> figureVariances(const ShapeFit& fit, Figures&& figuresOf) {
  constexpr std::size_t kMost = ShapeFit::kMost;
  std::array<std::array<double, kMost>, N> slopes{};
  for (std::size_t k = 0; k < static_cast<std::size_t>(fit.numbers); ++k) {
    const double error = std::sqrt(std::max(0.0, fit.covariance[k * kMost + k]));
    // Small beside the error, over which figures are straight, and large beside rounding.
    const double step = std::clamp(0.01 * error, 1e-8, 1e-4);
    std::array<double, kMost> by{};
    by[k] = step;
    const std::array<double, N> up = figuresOf(fit.moved(by));
    by[k] = -step;
    const std::array<double, N> down = figuresOf(fit.moved(by));
    for (std::size_t f = 0; f < N; ++f) slopes[f][k] = (up[f] - down[f]) * (0.5 / step);
  }
  std::array<double, N> variances{};
  for (std::size_t f = 0; f < N; ++f) {
    double sum = 0.0;
    for (std::size_t a = 0; a < kMost; ++a)
      for (std::size_t b = 0; b < kMost; ++b)
        sum += slopes[f][a] * slopes[f][b] * fit.covariance[a * kMost + b];
    variances[f] = sum < 0.0 ? 0.0 : sum;  // NaN stays
  }
  return variances;
}

}  // namespace fettle::engine
