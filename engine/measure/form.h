#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/sample_rect.h"
#include "engine/field/version.h"
#include "engine/measure/region.h"

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
};

struct FormOptions {
  int degree = 1;  ///< 0 .. PolynomialForm::kMostDegree
  Region region = Region::kAll;
  /// Samples far from the form, as of steps and spikes, do not count: from the plane with the least median distance
  /// (P. Rousseeuw, Least median of squares regression, 1984), of those through 300 triples of 4,096 samples, by
  /// Tukey's biweight at 4.685 times the normalised median distance (an MM-estimate: V. Yohai, High breakdown-point and
  /// high efficiency robust estimates for regression, 1987), one degree after the other. Half of the samples must be
  /// nearer to the form than the others are.
  bool robust = false;
};

struct FormFit {
  PolynomialForm form;
  std::int64_t samples = 0;  ///< of the region
  double rms = 0.0;  ///< of the region's samples about the form, each with the same weight [height_unit]
  int rounds = 1;    ///< of weights
};

/// Fits a form to the samples of a region, signs applied, by least squares in columns, rows and heights. Terms that the
/// samples do not determine (a single row, three samples) take the solution of least size, so that a form always
/// passes as near the samples as it can.
///
/// Accuracy: sums in double, compensated over the tiles; Chebyshev's basis keeps the equations' condition below 1e4
/// on a full field, so that a polynomial of that degree is found to 1e-11 of its range. Bit-identical for any number
/// of threads. Cost: one pass, with `robust` some 10 to 40 for each degree. Errors: kInput for a degree out of range or a region
/// without samples; kCancelled. Throws std::bad_alloc. Thread: any; a long job on all workers of the calling arena.
[[nodiscard]] Result<FormFit> fitForm(const Version& field, const FormOptions& options, JobControl& job);

/// The field without the form: height - form, signs applied, rounded to float once. Holes, marks, edge lines and the
/// field's place stay. Errors: kFailed without memory; kCancelled. Thread: as fitForm.
[[nodiscard]] Result<Version> withoutForm(const Version& field, const PolynomialForm& form, JobControl& job);

}  // namespace fettle::engine
