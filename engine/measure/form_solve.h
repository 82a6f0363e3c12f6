#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/field/grid.h"
#include "engine/field/polynomial_form.h"

namespace fettle::engine {

/// Where a polynomial of one axis has its -1 .. 1 while it is fitted: over the samples from `first`, `count` of them. A single
/// sample is at 0, its neighbours at -1 and 1.
struct FormAxis {
  std::int32_t first = 0, count = 1;

  [[nodiscard]] double scaled(double index) const noexcept {
    return count > 1 ? 2.0 * (index - first) / (count - 1) - 1.0 : index - first;
  }

  friend bool operator==(const FormAxis&, const FormAxis&) = default;
};
struct FormAxes {
  FormAxis columns, rows;

  friend bool operator==(const FormAxes&, const FormAxes&) = default;
};

/// Sums of the normal equations of a form over samples, with T_a and T_b of the axes.
struct FormProducts {
  static constexpr std::size_t kDegrees = PolynomialForm::kMostDegree + 1;
  std::array<std::array<double, 2 * kDegrees - 1>, 2 * kDegrees - 1> weight{};  ///< of weight T_a T_b
  std::array<std::array<double, kDegrees>, kDegrees> height{};                  ///< of weight height T_a T_b
};

struct SolvedForm {
  std::vector<double> coefficients;  ///< over the field, as PolynomialForm has them
  int terms =
      0;  ///< PolynomialForm::terms(); over a field of one row or column without those across it, which are 0
  int decided = 0;  ///< of how many combinations of these the samples say the size
  /// The terms with an open size, but the constant one, about the middle of the samples: "x, y"; empty where all are decided.
  std::string open;
};

/// The form of a degree that is nearest to the samples by least squares. Where they leave terms open (fewer samples than terms, samples on one
/// line) it is the flattest of those that are: the one with the least mean square gradient over the grid, by mm along and across. A
/// plane of one sample is level, one of samples on a line rises along it alone.
///
/// Open are combinations of terms below 1e-13 of the largest in the normal equations; and terms x^i y^j of a region of 1 / a and 1 / b of the
/// field with a^i b^j > 1e8, whose rounding would be seen over the field, as of degree 5 in a 40th of it: these are 0 about the region.
/// Throws std::bad_alloc. Thread: any.
[[nodiscard]] SolvedForm solveForm(const FormProducts& sums, int degree, const FormAxes& axes,
                                   const Grid& grid);

}  // namespace fettle::engine
