#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Dense>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "engine/measure/fit_samples.h"
#include "engine/measure/fit_solve.h"

namespace fettle::engine {

/// What a sample adds to the sums over a solution of a fit (fit_errors.h, fit_lines.h).
class FitTerms {
 public:
  FitTerms(const FitModel& model, const FitWeights& weights)
      : rows_(model, Eigen::VectorXd::Zero(model.size())), weights_(weights), row(model.size()) {}

  /// Takes the sample at a point in parts of the scale; false: it does not count.
  bool take(const glm::dvec3& p) {
    const FitPlace on = placeOf(rows_.surface(), weights_, p);
    residual = on.residual;
    share = weights_.share(residual);
    if (share == 0.0) return false;
    rows_.derivatives(on.at, on.point, row.data());
    row *= on.factor;
    slope = 1.0;
    if (weights_.robust_scale > 0.0) {
      const double x2 = std::pow(residual / (FitWeights::kTukey * weights_.robust_scale), 2);
      slope = (1.0 - x2) * (1.0 - 5.0 * x2);
    }
    cosine = on.factor * std::max(std::abs(on.at.gradient.z), FitWeights::kSteepest);
    return true;
  }

 private:
  FitModel::Rows rows_;
  FitWeights weights_;

 public:
  Eigen::VectorXd row;    ///< derivatives of the weighted distance by the numbers
  double residual = 0.0;  ///< the weighted distance
  double share = 0.0;     ///< of the residual that counts
  double slope = 0.0;     ///< derivative of what counts by the residual
  double cosine = 0.0;    ///< what noise in height is of a weighted distance
};

/// Equal parts of a region's rectangle, kSide rows of kSide.
class FitParts {
 public:
  static constexpr int kSide = 12;

  explicit FitParts(const FitPoints& points)
      : low_(points.samples->low()), size_(points.samples->high() - low_), scale_(points.scale) {}
  /// Of a point in parts of the scale.
  [[nodiscard]] std::size_t rowOf(const glm::dvec3& p) const noexcept {
    return placed(p.y * scale_ - low_.y, size_.y);
  }
  [[nodiscard]] std::size_t columnOf(const glm::dvec3& p) const noexcept {
    return placed(p.x * scale_ - low_.x, size_.x);
  }
  [[nodiscard]] std::size_t of(const glm::dvec3& p) const noexcept { return kSide * rowOf(p) + columnOf(p); }

 private:
  static std::size_t placed(double from, double whole) noexcept {
    return whole > 0.0
               ? static_cast<std::size_t>(std::clamp(static_cast<int>(from / whole * kSide), 0, kSide - 1))
               : 0;
  }
  glm::dvec2 low_, size_;
  double scale_;
};

}  // namespace fettle::engine
