#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/Dense>

#include "engine/measure/fit.h"
#include "engine/measure/fit_solve.h"
#include "engine/measure/fit_variance.h"

namespace fettle::engine {

/// What noise in height moves the fitted numbers by on average, to second order in the noise: M. Box, Bias in nonlinear estimation (1971), with
/// the covariance of the fit for the curvature of distances by the numbers, and with what noise does to the distances themselves. That is the
/// larger share of orthogonal ones: noise along z moves a sample across the surface, too, and of a curved or inclined one not alike to both sides. It
/// goes by the variance of the noise alone, so that more samples do not make it smaller; along z there is none.
///
/// `variance`: of a sample's height [scale^2]; `covariance`: of the numbers. Robust weights are left out. By at most some 4,000 of the samples,
/// which are a share of all that does not follow their rows. Any thread.
[[nodiscard]] Eigen::VectorXd numbersBias(const FitPoints& points, const FitWeights& weights,
                                          const FitModel& model, double variance,
                                          const Eigen::MatrixXd& covariance);

/// The same of N figures of a shape, as figureVariances has them: with the curvature of the figures by the numbers. NaN where the fit states no
/// covariance.
template <std::size_t N, class Figures>
[[nodiscard]] std::array<double, N> figureBiases(const ShapeFit& fit, Figures&& figuresOf) {
  constexpr std::size_t kMost = ShapeFit::kMost;
  const int n = fit.numbers;
  Eigen::MatrixXd covariance(n, n);
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b)
      covariance(a, b) = fit.covariance[static_cast<std::size_t>(a) * kMost + static_cast<std::size_t>(b)];
  std::array<double, N> biases{};
  if (!covariance.allFinite()) {
    biases.fill(std::nan(""));
    return biases;
  }
  const auto movedBy = [&](const Eigen::VectorXd& by) {
    std::array<double, kMost> numbers{};
    for (int k = 0; k < n; ++k) numbers[static_cast<std::size_t>(k)] = by[k];
    return figuresOf(fit.moved(numbers));
  };
  const std::array<double, N> at = movedBy(Eigen::VectorXd::Zero(n));
  const Eigen::Map<const Eigen::VectorXd> bias(fit.bias.data(), n);
  const std::array<double, N> up = movedBy(bias), down = movedBy(-bias);
  for (std::size_t f = 0; f < N; ++f) biases[f] = 0.5 * (up[f] - down[f]);
  // One standard error to both sides of each axis of the covariance.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(covariance);
  for (int k = 0; k < n; ++k) {
    const Eigen::VectorXd by = std::sqrt(std::max(0.0, axes.eigenvalues()[k])) * axes.eigenvectors().col(k);
    const std::array<double, N> more = movedBy(by), less = movedBy(-by);
    for (std::size_t f = 0; f < N; ++f) biases[f] += 0.5 * (more[f] + less[f] - 2.0 * at[f]);
  }
  return biases;
}

}  // namespace fettle::engine
