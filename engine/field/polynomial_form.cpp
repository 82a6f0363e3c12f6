#include "engine/field/polynomial_form.h"

#include <algorithm>
#include <cassert>

#include "engine/field/tile.h"

namespace fettle::engine {

namespace {

constexpr int kMostFormDegree = PolynomialForm::kMostDegree;

}  // namespace

double PolynomialForm::heightAt(double column, double row) const noexcept {
  double t[kMostFormDegree + 1], s[kMostFormDegree + 1];
  chebyshev(scaled(column, width), degree, t);
  chebyshev(scaled(row, height), degree, s);
  double sum = 0.0;
  std::size_t k = 0;
  for (int i = 0; i <= degree; ++i)
    for (int j = 0; i + j <= degree; ++j) sum += coefficients[k++] * t[i] * s[j];
  return base + sum;
}

void PolynomialForm::readHeights(const SampleRect& rect, double* out, std::ptrdiff_t stride) const noexcept {
  constexpr int kMostColumns = kTileSide + 1;
  assert(rect.columns <= kMostColumns);
  double t[kMostFormDegree + 1][kMostColumns];
  for (int c = 0; c < rect.columns; ++c) {
    double here[kMostFormDegree + 1];
    chebyshev(scaled(rect.column + c, width), degree, here);
    for (int i = 0; i <= degree; ++i) t[i][c] = here[i];
  }
  for (int r = 0; r < rect.rows; ++r) {
    double s[kMostFormDegree + 1];
    chebyshev(scaled(rect.row + r, height), degree, s);
    double* const line = out + r * stride;
    std::fill_n(line, rect.columns, 0.0);
    std::size_t k = 0;
    for (int i = 0; i <= degree; ++i) {
      double factor = 0.0;
      for (int j = 0; i + j <= degree; ++j) factor += coefficients[k++] * s[j];
      for (int c = 0; c < rect.columns; ++c) line[c] += factor * t[i][c];
    }
    // Last, and rounded once: a base of 5e6 is rounded to 1e-9, and once for each term would be visible in small heights.
    for (int c = 0; c < rect.columns; ++c) line[c] += base;
  }
}

PolynomialForm::Gradient PolynomialForm::gradient() const noexcept {
  // T_k'(0) = k sin(k pi / 2), T_k(0) = cos(k pi / 2).
  constexpr double kValue[] = {1.0, 0.0, -1.0, 0.0, 1.0, 0.0};
  constexpr double kSlope[] = {0.0, 1.0, 0.0, -3.0, 0.0, 5.0};
  Gradient gradient;
  std::size_t k = 0;
  for (int i = 0; i <= degree; ++i)
    for (int j = 0; i + j <= degree; ++j, ++k) {
      gradient.by_column += coefficients[k] * kSlope[i] * kValue[j];
      gradient.by_row += coefficients[k] * kValue[i] * kSlope[j];
    }
  gradient.by_column *= width > 1 ? 2.0 / (width - 1) : 0.0;
  gradient.by_row *= height > 1 ? 2.0 / (height - 1) : 0.0;
  return gradient;
}

}  // namespace fettle::engine
