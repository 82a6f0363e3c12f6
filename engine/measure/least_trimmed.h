#pragma once

#include <span>
#include <vector>

#include "engine/field/polynomial_form.h"
#include "engine/measure/form_solve.h"

namespace fettle::engine {

/// A sample of a field: its place [samples] and its height.
struct FormSample {
  double column = 0.0, row = 0.0, z = 0.0;
};

/// The median distance of samples from a form [height_unit]; 0 of none.
[[nodiscard]] double medianDistance(std::span<const FormSample> samples, const PolynomialForm& form);

/// The form, of some tried, with the least median distance from the samples: 500 times as many samples as it has terms are
/// drawn at random; of the form through them the one of the nearer half follows, twice, and of the best five of these until
/// they rest (P. Rousseeuw, K. Van Driessen, Computing LTS regression for large data sets, 2006). It is a start for weighted fits
/// where what stands on a bent surface would be taken for its bend by a plane.
///
/// `form` has the degree, the field's sides and the base. At most 1,024 of the samples are used; the same ones are drawn for
/// the same input, on any machine. More than half of them must lie on the form: with a share s beside it, all samples of a
/// draw lie on it once in (1 - s)^-terms draws. Some 0.1 s for degree 5. Throws std::bad_alloc. Thread: any.
[[nodiscard]] PolynomialForm leastTrimmedForm(std::span<const FormSample> samples, const PolynomialForm& form,
                                              const FormAxes& axes, const Grid& grid);

}  // namespace fettle::engine
