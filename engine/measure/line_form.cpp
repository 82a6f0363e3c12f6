#include "engine/measure/line_form.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Dense>

namespace fettle::engine {

namespace {

constexpr std::int32_t kLinesPerTerm = 4;

// Legendre's polynomials of degree 0 .. terms - 1 at each of `lines` places in -1 .. 1: nearly orthogonal over the lines, so that
// nine of them lose no digits.
Eigen::MatrixXd basisOver(std::int32_t lines, int terms) {
  Eigen::MatrixXd basis(lines, terms);
  for (std::int32_t l = 0; l < lines; ++l) {
    const double x = lines > 1 ? 2.0 * l / (lines - 1) - 1.0 : 0.0;
    basis(l, 0) = 1.0;
    if (terms > 1) basis(l, 1) = x;
    for (int k = 2; k < terms; ++k)
      basis(l, k) = ((2 * k - 1) * x * basis(l, k - 1) - (k - 1) * basis(l, k - 2)) / k;
  }
  return basis;
}

}  // namespace

void leaveForm(LineOffsets& offsets, std::span<const std::int64_t> counts, int degree) {
  const auto known =
      static_cast<std::int32_t>(std::ranges::count_if(counts, [](std::int64_t n) { return n > 0; }));
  const int across = std::max(1, std::min(degree + 1, known / kLinesPerTerm));
  const Eigen::MatrixXd basis = basisOver(offsets.lines, across);
  Eigen::MatrixXd of_known(known, across);
  for (std::int32_t l = 0, k = 0; l < offsets.lines; ++l)
    if (counts[static_cast<std::size_t>(l)] > 0) of_known.row(k++) = basis.row(l);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(of_known);
  const auto along = static_cast<Eigen::Index>(offsets.degree) + 1;
  using ByLine = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<ByLine> taken(offsets.coefficients.data(), offsets.lines, along);
  Eigen::MatrixXd of_lines(known, along);
  for (std::int32_t l = 0, k = 0; l < offsets.lines; ++l)
    if (counts[static_cast<std::size_t>(l)] > 0) of_lines.row(k++) = taken.row(l);
  const Eigen::MatrixXd form = basis * solver.solve(of_lines);
  taken -= form;
  const double mean = form.col(0).mean();
  offsets.form_rms = std::sqrt((form.col(0).array() - mean).square().mean());
}

}  // namespace fettle::engine
