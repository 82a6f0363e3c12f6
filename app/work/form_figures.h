#pragma once

#include <string>

#include "app/report.h"
#include "engine/field/grid.h"
#include "engine/field/nominal_form.h"
#include "engine/measure/fit_shape.h"

namespace fettle::app {

// What a form is like, without how it was found: as keys of reports and as text.

/// point_mm, direction but of a sphere, half_angle_deg of a cone or radius_mm, hollow.
void addShape(Report& report, const engine::Shape& shape);

/// Those of a shape; of a plane and more tilt_x, tilt_y [degrees]; of a mean height level [height_unit]. `form`: of heights as they are seen.
void addFormFigures(Report& report, const engine::NominalForm& form, const engine::Grid& grid);

/// The same as a line of text: "radius 12.5 mm, hollow, centre at 3, 4.1, -12 mm", "half angle 30.1 degrees, apex at ...", "tilted 0.2 degrees along x,
/// -0.03 along y". `unit`: of heights.
[[nodiscard]] std::string formFiguresText(const Report& report, const std::string& unit);
[[nodiscard]] std::string formFigures(const engine::NominalForm& form, const engine::Grid& grid);

}  // namespace fettle::app
