#pragma once

#include <optional>

#include "engine/field/grid.h"
#include "engine/field/nominal_form.h"
#include "engine/measure/fit_shape.h"

namespace fettle::engine {

/// How a polynomial is tilted in the middle of its field [degrees], up to higher x and y.
struct Tilt {
  double x_deg = 0.0, y_deg = 0.0;
  /// Standard errors, of a plane through three points; else NaN, as where each has but one sample.
  double x_error_deg = 0.0, y_error_deg = 0.0;
};

/// Of a form over a field of this grid, without errors; none of a shape, and of a mean height. Any thread.
[[nodiscard]] std::optional<Tilt> tiltOf(const NominalForm& form, const Grid& grid);

/// Centre, axis, apex and size of a form that is a sphere, cylinder or cone, in millimetres of field coordinates, heights as they are. The
/// point of a cylinder is the one on its axis below or above the form's foot, in the direction of the normal there. To 1e-15 of the
/// radius and of the place. Any thread.
[[nodiscard]] Shape shapeOfForm(const ShapeForm& form);

}  // namespace fettle::engine
