#pragma once

#include <glm/vec2.hpp>

#include "engine/base/error.h"
#include "engine/field/version.h"
#include "engine/measure/region.h"
#include "engine/measure/section_figures.h"

namespace fettle::engine {

/// The surface at a point, by the quadratic that is nearest to the samples around.
struct ProbeFigures {
  Estimate height_mm;
  Estimate slope_deg;         ///< of the steepest direction
  double rises_to_deg = 0.0;  ///< direction in which it rises, anticlockwise from x; NaN where it is level
  /// Curvatures of the two principal directions [1/mm], above 0 hollow, the greater one first, and of their mean.
  double most_curvature = 0.0, least_curvature = 0.0;
  Estimate mean_curvature;
  double rms_mm = 0.0;
  int samples = 0;
};

/// Fits z = a + b x + c y + d x^2 + e x y + f y^2 by least squares to the samples of the region within `radius_mm` of
/// `at` (field coordinates [mm]). Curvatures are those of the graph (M. do Carmo, Differential geometry of curves and
/// surfaces, 1976, section 3.3). `noise` as in section_figures.h: that of rows and columns
/// counts as the samples lie in them, and what the samples scatter beyond it and their own is noise of theirs. Errors (kInput): samples that do not determine a
/// quadratic; more than 2^22 of them. Thread: any.
[[nodiscard]] Result<ProbeFigures> probeAt(const Version& field, glm::dvec2 at, double radius_mm,
                                           Region region, const SectionNoise& noise);

}  // namespace fettle::engine
