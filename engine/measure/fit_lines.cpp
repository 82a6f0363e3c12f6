#include "engine/measure/fit_lines.h"

#include <cmath>
#include <cstddef>
#include <cstdint>

#include <tbb/parallel_for.h>

namespace fettle::engine {

FitLineSums::FitLineSums(const FitPoints& points, const FitWeights& weights, const FitModel& model)
    : numbers_(model.size()) {
  const FitSamples& samples = *points.samples;
  const FitSamples::Lattice lattice = samples.lattice();
  const FitParts parts(points);
  const int n = numbers_, stacked = kSide * n;
  rows_ = lattice.rows;
  columns_ = lattice.columns;
  information_.assign(kSide * kSide, Eigen::MatrixXd::Zero(n, n));
  noise_ = information_;
  by_rows_.fill(Eigen::MatrixXd::Zero(stacked, stacked));
  by_columns_ = by_rows_;
  // The first block of each row of parts: blocks come by row, and a row lies in one row of parts.
  std::array<std::size_t, kSide + 1> first{};
  first.fill(samples.blocks());
  for (std::size_t b = samples.blocks(); b-- > 0;)
    first[parts.rowOf({0.0, samples.along(b).y / points.scale, 0.0})] = b;
  for (std::size_t k = kSide; k-- > 0;) first[k] = std::min(first[k], first[k + 1]);
  // A column's sums in each row of parts.
  Eigen::MatrixXd of_columns = Eigen::MatrixXd::Zero(stacked, columns_);
  tbb::parallel_for(std::size_t{0}, std::size_t{kSide}, [&](std::size_t band) {
    FitTerms terms(model, weights);
    FitSamples::Block some;
    Eigen::MatrixXd of_row = Eigen::MatrixXd::Zero(n, kSide);
    const auto finishRow = [&] {
      const Eigen::Map<const Eigen::VectorXd> all(of_row.data(), stacked);
      by_rows_[band].noalias() += all * all.transpose();
      of_row.setZero();
    };
    std::int32_t row = -1;
    for (std::size_t b = first[band]; b < first[band + 1]; ++b) {
      samples.read(b, some);
      if (some.row != row && row >= 0) finishRow();
      row = some.row;
      for (int i = 0; i < some.count; ++i) {
        const glm::dvec3 p = some.points[static_cast<std::size_t>(i)] / points.scale;
        if (!terms.take(p)) continue;
        const std::size_t column = parts.columnOf(p), part = kSide * band + column;
        information_[part].noalias() += terms.slope * terms.row * terms.row.transpose();
        terms.row *= terms.cosine;
        noise_[part].noalias() += terms.row * terms.row.transpose();
        of_row.col(static_cast<Eigen::Index>(column)) += terms.row;
        of_columns.col(some.column - lattice.column + i).segment(static_cast<Eigen::Index>(band) * n, n) +=
            terms.row;
      }
    }
    finishRow();
  });
  for (int c = 0; c < columns_; ++c) {
    const double x = samples.xOf(c) / points.scale;
    const std::size_t column = parts.columnOf({x, 0.0, 0.0});
    by_columns_[column].noalias() += of_columns.col(c) * of_columns.col(c).transpose();
  }
}

Eigen::MatrixXd FitLineSums::withAll(const FitNoise& noise, int row, int column) const {
  Eigen::MatrixXd sums = noise.sample * noiseOf(row, column);
  for (int k = 0; k < kSide; ++k) {
    sums += noise.rows * block(by_rows_, row, column, k);
    sums += noise.columns * block(by_columns_, column, row, k);
  }
  return sums;
}

Eigen::MatrixXd FitLineSums::covariance(const FitNoise& noise) const {
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(numbers_, numbers_);
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) sums += withAll(noise, r, c);
  return sums;
}

FitLineSums::Expected FitLineSums::expected(const FitNoise& noise, const Eigen::MatrixXd& inverse) const {
  const Eigen::MatrixXd all = covariance(noise);
  Expected result{Eigen::MatrixXd::Zero(numbers_, numbers_)};
  // Of a part's sum s less what the fit takes, M A^-1 g with the information M of the part and the sum g over all.
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) {
      const Eigen::MatrixXd taken = information_[static_cast<std::size_t>(r * kSide + c)] * inverse;
      const Eigen::MatrixXd common = withAll(noise, r, c) * taken.transpose();
      result.squares += noise.sample * noiseOf(r, c) + noise.rows * block(by_rows_, r, c, c) +
                        noise.columns * block(by_columns_, c, r, r) - common - common.transpose() +
                        taken * all * taken.transpose();
    }
  // Of Gaussian sums s of parts the variance of sum s^T E^-1 s is 2 sum trace(E^-1 C E^-1 C^T) over pairs of parts.
  const Eigen::LDLT<Eigen::MatrixXd> by(result.squares);
  double squares = 0.0;
  const auto add = [&](const Eigen::MatrixXd& pair, double times) {
    const Eigen::MatrixXd a = by.solve(pair), b = by.solve(Eigen::MatrixXd(pair.transpose()));
    squares += times * 2.0 * (a * b).trace();
  };
  for (int line = 0; line < kSide; ++line)
    for (int a = 0; a < kSide; ++a) {
      add(noise.sample * noiseOf(line, a) + noise.rows * block(by_rows_, line, a, a) +
              noise.columns * block(by_columns_, a, line, line),
          1.0);
      for (int b = 0; b < a; ++b) {
        add(noise.rows * block(by_rows_, line, a, b), 2.0);
        add(noise.columns * block(by_columns_, line, a, b), 2.0);
      }
    }
  result.scatter = std::sqrt(squares) / numbers_;
  return result;
}

}  // namespace fettle::engine
