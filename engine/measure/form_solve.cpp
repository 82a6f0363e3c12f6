#include "engine/measure/form_solve.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Dense>

namespace fettle::engine {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLeast =
    1e-13;  // of the normal equations' largest, below which a combination of terms is open
constexpr double kMostGrown = 1e8;

// Exponents of the terms in the order of PolynomialForm::coefficients.
std::vector<std::pair<int, int>> termsOf(int degree) {
  std::vector<std::pair<int, int>> terms;
  for (int i = 0; i <= degree; ++i)
    for (int j = 0; i + j <= degree; ++j) terms.emplace_back(i, j);
  return terms;
}

// T_k(slope x + offset) for k = 0 .. degree, a row for each, as sums of T_l(x); `monomial`: of x^l.
enum class Basis : std::uint8_t { kChebyshev, kMonomial };
MatrixXd moved(int degree, double slope, double offset, Basis basis) {
  MatrixXd rows = MatrixXd::Zero(degree + 1, degree + 1);
  rows(0, 0) = 1.0;
  const auto timesArgument = [&](const VectorXd& of) {
    VectorXd result = offset * of;
    for (int l = 0; l <= degree; ++l) {
      if (of(l) == 0.0) continue;
      const double times = slope * of(l);
      if (basis == Basis::kMonomial || l == 0) {
        if (l < degree) result(l + 1) += times;
        continue;
      }
      // x T_l = (T_(l+1) + T_(l-1)) / 2
      if (l < degree) result(l + 1) += 0.5 * times;
      result(l - 1) += 0.5 * times;
    }
    return result;
  };
  if (degree > 0) rows.row(1) = timesArgument(rows.row(0).transpose()).transpose();
  for (int k = 2; k <= degree; ++k)
    rows.row(k) = 2.0 * timesArgument(rows.row(k - 1).transpose()).transpose() - rows.row(k - 2);
  return rows;
}

// The argument over a FormAxis as slope and offset of that over `side` samples.
std::pair<double, double> axisOver(const FormAxis& axis, std::int32_t side) {
  if (side < 2) return {1.0, 0.0};  // one place alone
  // Exactly 1 and 0 over all of the field.
  return {axis.count > 1 ? (side - 1.0) / (axis.count - 1.0) : 0.5 * (side - 1),
          axis.scaled(0.5 * (side - 1))};
}

// Coefficients over axes of their own to those in another basis: a column for each term.
MatrixXd termsMoved(const std::vector<std::pair<int, int>>& terms, const MatrixXd& x, const MatrixXd& y) {
  const auto n = static_cast<Eigen::Index>(terms.size());
  MatrixXd result(n, n);
  for (Eigen::Index p = 0; p < n; ++p)
    for (Eigen::Index q = 0; q < n; ++q) {
      const auto& [k, l] = terms[static_cast<std::size_t>(p)];
      const auto& [i, j] = terms[static_cast<std::size_t>(q)];
      result(p, q) = x(i, k) * y(j, l);
    }
  return result;
}

// Four times the mean over the field of the product of two forms' gradients, for each pair of terms.
MatrixXd gradientProducts(const std::vector<std::pair<int, int>>& terms, const Grid& grid) {
  constexpr int kHighest = PolynomialForm::kMostDegree;
  // Integrals over -1 .. 1 of T_i T_k and of their derivatives; a derivative is 2 k (T_(k-1) + T_(k-3) + ...), of T_0 a half.
  MatrixXd value(kHighest + 1, kHighest + 1), derivative = MatrixXd::Zero(kHighest + 1, kHighest + 1);
  const auto integral = [](int k) { return k % 2 != 0 ? 0.0 : 2.0 / (1.0 - double{1} * k * k); };
  for (int i = 0; i <= kHighest; ++i) {
    for (int k = 0; k <= kHighest; ++k) value(i, k) = 0.5 * (integral(i + k) + integral(std::abs(i - k)));
    for (int k = i - 1; k >= 0; k -= 2) derivative(i, k) = k == 0 ? i : 2.0 * i;
  }
  const MatrixXd slope = derivative * value * derivative.transpose();
  const double half_x = 0.5 * std::max(grid.width - 1, 1) * grid.spacingXMm(),
               half_y = 0.5 * std::max(grid.height - 1, 1) * grid.spacingYMm();
  // Only the ratio counts.
  const double by_x = std::min(half_x, half_y) / half_x, by_y = std::min(half_x, half_y) / half_y;
  const auto n = static_cast<Eigen::Index>(terms.size());
  MatrixXd result(n, n);
  for (Eigen::Index p = 0; p < n; ++p)
    for (Eigen::Index q = 0; q < n; ++q) {
      const auto& [i, j] = terms[static_cast<std::size_t>(p)];
      const auto& [k, l] = terms[static_cast<std::size_t>(q)];
      result(p, q) = by_x * by_x * slope(i, k) * value(j, l) + by_y * by_y * value(i, k) * slope(j, l);
    }
  return result;
}

std::string monomialText(int i, int j) {
  const auto power = [](const char* name, int of) {
    return of == 0 ? std::string() : of == 1 ? std::string(name) : fmt::format("{}^{}", name, of);
  };
  const std::string x = power("x", i), y = power("y", j);
  return x + (x.empty() || y.empty() ? "" : " ") + y;
}

// The terms about the middle of the samples that some combination in `open` has, the lowest degree first.
std::string openText(const std::vector<std::pair<int, int>>& terms, const MatrixXd& open,
                     const std::vector<bool>& unseen) {
  constexpr double kPart = 1e-6;
  constexpr std::size_t kShown = 6;
  const int degree = terms.back().first;
  const MatrixXd axis = moved(degree, 1.0, 0.0, Basis::kMonomial);
  const MatrixXd monomials = termsMoved(terms, axis, axis) * open;
  std::vector<std::pair<int, int>> found;
  for (std::size_t p = 0; p < terms.size(); ++p) {
    if (terms[p].first + terms[p].second == 0) continue;
    const auto row = static_cast<Eigen::Index>(p);
    if (unseen[p] || (open.cols() > 0 && monomials.row(row).cwiseAbs().maxCoeff() > kPart))
      found.push_back(terms[p]);
  }
  std::ranges::stable_sort(found, [](const auto& a, const auto& b) {
    const int of_a = a.first + a.second, of_b = b.first + b.second;
    return of_a < of_b || (of_a == of_b && a.first > b.first);
  });
  std::string text;
  for (std::size_t k = 0; k < std::min(found.size(), kShown); ++k)
    text += fmt::format("{}{}", k == 0 ? "" : ", ", monomialText(found[k].first, found[k].second));
  if (found.size() > kShown) text += fmt::format(" and {} more", found.size() - kShown);
  return text;
}

}  // namespace

SolvedForm solveForm(const FormProducts& sums, int degree, const FormAxes& axes, const Grid& grid) {
  const std::vector<std::pair<int, int>> all = termsOf(degree);
  const auto product = [&](int a, int b) {
    return sums.weight[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
  };
  const auto [slope_x, offset_x] = axisOver(axes.columns, grid.width);
  const auto [slope_y, offset_y] = axisOver(axes.rows, grid.height);
  SolvedForm result;
  std::vector<bool> unseen;
  std::vector<std::size_t> kept;
  for (std::size_t p = 0; p < all.size(); ++p) {
    const auto [i, j] = all[p];
    const bool nowhere = (i > 0 && grid.width < 2) || (j > 0 && grid.height < 2);
    unseen.push_back(!nowhere && std::pow(slope_x, i) * std::pow(slope_y, j) > kMostGrown);
    if (!nowhere) ++result.terms;
    if (!nowhere && !unseen.back()) kept.push_back(p);
  }
  const auto n = static_cast<Eigen::Index>(kept.size()), terms = static_cast<Eigen::Index>(all.size());
  MatrixXd normal(n, n);
  VectorXd right(n);
  for (Eigen::Index p = 0; p < n; ++p) {
    const auto [i, j] = all[kept[static_cast<std::size_t>(p)]];
    for (Eigen::Index q = 0; q < n; ++q) {
      const auto [k, l] = all[kept[static_cast<std::size_t>(q)]];
      normal(p, q) = 0.25 * (product(i + k, j + l) + product(std::abs(i - k), j + l) +
                             product(i + k, std::abs(j - l)) + product(std::abs(i - k), std::abs(j - l)));
    }
    right(p) = sums.height[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  }
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> decomposition;
  decomposition.setThreshold(kLeast);
  decomposition.compute(normal);

  VectorXd solution = decomposition.solve(right);
  MatrixXd open(n, 0);
  const MatrixXd over = termsMoved(all, moved(degree, slope_x, offset_x, Basis::kChebyshev),
                                   moved(degree, slope_y, offset_y, Basis::kChebyshev));
  const auto whole = [&](const MatrixXd& of) {  // with the terms that are none
    MatrixXd columns = MatrixXd::Zero(terms, of.cols());
    for (Eigen::Index p = 0; p < n; ++p)
      columns.row(static_cast<Eigen::Index>(kept[static_cast<std::size_t>(p)])) = of.row(p);
    return columns;
  };
  if (decomposition.rank() < n) {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> parts(normal);
    const VectorXd& sizes = parts.eigenvalues();  // from the least
    Eigen::Index none = 0;
    while (none < n && !(sizes(none) > kLeast * sizes(n - 1))) ++none;
    const MatrixXd decided = parts.eigenvectors().rightCols(n - none);
    open = parts.eigenvectors().leftCols(none);
    solution =
        decided * (decided.transpose() * right).cwiseQuotient(sizes.tail(n - none).cwiseMax(0.0)).eval();
    if (none > 0 && n > 1) {
      // Along what is open to where the gradient is least; without the constant term, which has none.
      const MatrixXd gradients = gradientProducts(all, grid).bottomRightCorner(terms - 1, terms - 1);
      const MatrixXd root = gradients.llt().matrixU();
      const MatrixXd along = root * (over * whole(open)).bottomRows(terms - 1);
      const VectorXd from = root * (over * whole(solution)).bottomRows(terms - 1);
      solution -= open * along.completeOrthogonalDecomposition().solve(from);
    }
  }
  result.decided = static_cast<int>(n - open.cols());
  if (result.decided < result.terms) result.open = openText(all, whole(open), unseen);
  const VectorXd field = over * whole(solution);
  result.coefficients = {field.data(), field.data() + terms};
  return result;
}

}  // namespace fettle::engine
