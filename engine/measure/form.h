#pragma once

#include <cstdint>
#include <string>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/nominal_form.h"
#include "engine/field/polynomial_form.h"
#include "engine/field/version.h"
#include "engine/measure/region.h"

namespace fettle::engine {

struct FormOptions {
  int degree = 1;  ///< 0 .. PolynomialForm::kMostDegree
  Region region = Region::kAll;
  /// Samples far from the form, as of steps and spikes, do not count: from the plane with the least median distance
  /// (P. Rousseeuw, Least median of squares regression, 1984), of those through 300 triples of 4,096 samples, by
  /// Tukey's biweight at 4.685 times the normalised median distance (an MM-estimate: V. Yohai, High breakdown-point and
  /// high efficiency robust estimates for regression, 1987), one degree after the other; from leastTrimmedForm()
  /// (least_trimmed.h) where that is clearly nearer to most samples. Half of the samples must be nearer to the form than the others are.
  bool robust = false;
};

struct FormFit {
  PolynomialForm form;
  std::int64_t samples = 0;  ///< of the region
  double rms = 0.0;  ///< of the region's samples about the form, each with the same weight [height_unit]
  double rms_counted =
      0.0;  ///< with `robust` of those that count, which are nearer than Tukey's biweight reaches; else the same
  int rounds = 1;  ///< of weights
  /// Its terms, of how many combinations of them the samples say the size, and those they leave open, as solveForm() (form_solve.h):
  /// empty where they decide all.
  int terms = 0, decided = 0;
  std::string open = {};
};

/// Fits a form to the samples of a region, signs applied, by least squares in columns, rows and heights. Where the samples leave
/// terms open (a single row, fewer samples than terms) it is the flattest form of those that pass nearest to the samples, the one with the least
/// mean square gradient over the field: no field is refused that has a sample.
///
/// Accuracy: sums in double, compensated over the tiles; Chebyshev's basis keeps the equations' condition below 1e4
/// on a full field, so that a polynomial of that degree is found to 1e-11 of its range. Bit-identical for any number
/// of threads. Cost: two passes, three where the samples lie in less than
/// half of the field along an axis, with `robust` some 10 to 40 more for each degree. Errors: kInput for a degree out of range or a region
/// without samples; kCancelled. Throws std::bad_alloc. Thread: any; a long job on all workers of the calling arena.
[[nodiscard]] Result<FormFit> fitForm(const Version& field, const FormOptions& options, JobControl& job);

/// The field without the form: height - form, signs applied, rounded to float once. Holes, marks, edge lines and the
/// field's place stay. Errors: kFailed without memory; kCancelled. Thread: as fitForm.
[[nodiscard]] Result<Version> withoutForm(const Version& field, const NominalForm& form, JobControl& job);

}  // namespace fettle::engine
