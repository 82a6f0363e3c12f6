#pragma once

#include <array>
#include <vector>

#include <Eigen/Dense>

#include "engine/measure/fit_solve.h"
#include "engine/measure/fit_terms.h"

namespace fettle::engine {

/// Sizes of what the noise of samples consists of, as variances of what counts of a weighted distance.
struct FitNoise {
  double sample = 0.0;               ///< of a sample's own
  double rows = 0.0, columns = 0.0;  ///< of what all samples of a row, of a column have in common
  double height = 0.0;               ///< of a sample's height, with what its lines add
};

/// What noise that whole rows or columns of samples share does to the sums of a fit. With J the derivatives of weighted
/// distances and C the covariance of the noise, J^T C J is a sum over rows and columns of squares of the sums of J along them,
/// so that C itself is never formed.
class FitLineSums {
 public:
  /// One pass over the samples, of which a region has a row at least (FitSamples::lattice). Memory: 100 numbers a column of the
  /// region at most. Bit-identical for any number of threads. Throws std::bad_alloc.
  FitLineSums(const FitPoints& points, const FitWeights& weights, const FitModel& model);

  /// J^T C J for noise of these sizes.
  [[nodiscard]] Eigen::MatrixXd covariance(const FitNoise& noise) const;

  /// The sum over parts (FitParts) of squares of what is left of their sums of J^T noise after the fit, expected for noise of
  /// these sizes, with `inverse` that of all information; and the standard deviation that the mean over the numbers of the
  /// ratio of seen sums to expected ones has, for noise that the fit took nothing of.
  struct Expected {
    Eigen::MatrixXd squares;
    double scatter = 0.0;
  };
  [[nodiscard]] Expected expected(const FitNoise& noise, const Eigen::MatrixXd& inverse) const;

  [[nodiscard]] int rows() const noexcept { return rows_; }
  [[nodiscard]] int columns() const noexcept { return columns_; }

 private:
  static constexpr int kSide = FitParts::kSide;
  using Blocks = std::array<Eigen::MatrixXd, kSide>;

  [[nodiscard]] auto block(const Blocks& of, int line, int a, int b) const {
    return of[static_cast<std::size_t>(line)].block(a * numbers_, b * numbers_, numbers_, numbers_);
  }
  // Of the sums of a part with those of all.
  [[nodiscard]] Eigen::MatrixXd withAll(const FitNoise& noise, int row, int column) const;
  [[nodiscard]] const Eigen::MatrixXd& noiseOf(int row, int column) const {
    return noise_[static_cast<std::size_t>(row * kSide + column)];
  }

  int numbers_ = 0, rows_ = 0, columns_ = 0;
  std::vector<Eigen::MatrixXd> information_, noise_;  // of each part, by psi's slope and by noise in height
  // Products of a row's sums over parts beside each other, summed over the rows of a row of parts: [row of parts](column of
  // parts x number, the same). The other of a column's.
  Blocks by_rows_, by_columns_;
};

}  // namespace fettle::engine
