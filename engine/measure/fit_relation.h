#pragma once

#include "engine/measure/fit.h"
#include "engine/measure/section_figures.h"

namespace fettle::engine {

/// What lies between two fits of different samples.
struct ShapeRelation {
  /// Between normals, axes, or a normal and an axis as the angle between plane and axis [degrees], 0 to 90; NaN without
  /// two directions.
  Estimate angle_deg;
  /// Plane and another: of the other's point from the plane, above 0 above it; of two planes that of the middle of the
  /// second's samples from the first. Axis and another: from the other's point, of a second axis that nearest to the middle
  /// of its samples, to the first axis. Spheres, torus centres: between the points [mm].
  Estimate distance_mm;
  /// Two axes: the shortest distance between the lines; NaN else, and for parallel ones (angle below three errors).
  Estimate between_axes_mm;
};
[[nodiscard]] ShapeRelation relationOf(const ShapeFit& first, const ShapeFit& second) noexcept;

}  // namespace fettle::engine
