#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Dense>

#include "engine/base/error.h"
#include "engine/measure/fit.h"
#include "engine/measure/fit_lines.h"
#include "engine/measure/fit_solve.h"

namespace fettle::engine {

/// What the samples say about a solution, summed over them.
struct FitSums {
  Eigen::MatrixXd information, noise;  ///< of derivatives: by psi's, by what independent noise in height does
  std::vector<Eigen::VectorXd> scores;  ///< of each part of the region (FitParts)
  std::vector<std::int64_t> in_part;
  double squares = 0.0, psi_squares = 0.0, cosines = 0.0, largest = 0.0;
  std::int64_t used = 0, left_out = 0;
};
/// In an order that does not depend on the number of threads.
[[nodiscard]] FitSums fitSums(const FitPoints& points, const FitWeights& weights, const FitModel& model);

/// The covariance of the fitted numbers and ShapeFit::correlation from the sums, with `lines` where the options' noise has rows
/// or columns, else null; `rounding` of heights [mm]. Returns the variance of the noise of a sample's height that counts [scale^2], NaN where it is
/// not known. Errors: numbers that the samples do not determine.
[[nodiscard]] Result<double> setCovariance(ShapeFit& fit, const FitModel& model, const FitSums& sums,
                                           const FitLineSums* lines, const FitOptions& options,
                                           double rounding);

/// Refuses a fit, its covariance known, of which a radius, an apex, a ring or a direction is not determined (fitShape).
[[nodiscard]] Status checkDetermined(const ShapeFit& fit, const FitModel& model);

/// "the samples do not determine `what`", of a shape (kInput).
[[nodiscard]] tl::unexpected<Error> undetermined(ShapeKind kind, const std::string& what,
                                                 const std::string& remedy);

}  // namespace fettle::engine
