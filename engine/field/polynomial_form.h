#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/field/sample_rect.h"

namespace fettle::engine {

/// The nominal form of a surface: a polynomial of total degree 0 (a mean height), 1 (a plane) to 5 over a field.
struct PolynomialForm {
  static constexpr int kMostDegree = 5;

  int degree = 0;
  std::int32_t width = 1, height = 1;  ///< of the field [samples]
  double base = 0.0;                   ///< [height_unit], beside the terms
  /// [height_unit], of the terms T_i(u) T_j(v) with Chebyshev's polynomials T, u and v from -1 to 1 over the columns
  /// and the rows (0 where there is but one): i = 0 .. degree, for each j = 0 .. degree - i.
  std::vector<double> coefficients;

  /// Number of terms of a degree.
  [[nodiscard]] static constexpr int terms(int degree) noexcept { return (degree + 1) * (degree + 2) / 2; }

  /// Height at sample (column, row), also between and beyond samples [height_unit].
  [[nodiscard]] double heightAt(double column, double row) const noexcept;
  /// Heights of the samples of a rectangle of at most kTileSide + 1 columns, row-major, `stride` >= its columns.
  void readHeights(const SampleRect& rect, double* out, std::ptrdiff_t stride) const noexcept;
  /// Derivatives by column and by row in the middle of the field [height_unit per sample].
  struct Gradient {
    double by_column = 0.0, by_row = 0.0;
  };
  [[nodiscard]] Gradient gradient() const noexcept;

  /// Place of a sample in -1 .. 1: what u and v are.
  [[nodiscard]] static double scaled(double index, std::int32_t count) noexcept {
    return count > 1 ? 2.0 * index / (count - 1) - 1.0 : 0.0;
  }
  /// T_0(x) .. T_last(x).
  static void chebyshev(double x, int last, double* out) noexcept {
    out[0] = 1.0;
    if (last > 0) out[1] = x;
    for (int k = 2; k <= last; ++k) out[k] = 2.0 * x * out[k - 1] - out[k - 2];
  }

  friend bool operator==(const PolynomialForm&, const PolynomialForm&) = default;
};

}  // namespace fettle::engine
