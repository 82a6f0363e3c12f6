#pragma once

#include <optional>

#include <glm/vec3.hpp>

#include "engine/field/reader.h"

namespace fettle::render {

/// Where a half line hits the surface first.
struct SurfaceHit {
  glm::dvec3 position_mm{0.0};  ///< field coordinates
  std::int32_t column = 0;      ///< cell, by its lower-left sample
  std::int32_t row = 0;
  double along = 0.0;  ///< position = from + along * direction
};

/// Intersects a half line with the bilinear surface (cells without a hole at a corner) from either side,
/// exact except for rounding: height above a bilinear patch is quadratic along a line. `from`, `direction`:
/// field coordinates [mm], `direction` not zero, both finite; heights in millimetres with the version's sign.
/// Traverses the cells under the line (Amanatides and Woo 1987), squares of 8, 64, 512 ... cells in one step
/// where the line passes above or below all their heights. Empty: no hit. Double precision; allocates
/// nothing.
[[nodiscard]] std::optional<SurfaceHit> meetSurface(const engine::FieldReader& reader, const glm::dvec3& from,
                                                    const glm::dvec3& direction) noexcept;

/// Height of the surface at a position [mm]; empty over a hole or outside the field.
[[nodiscard]] std::optional<double> surfaceHeight(const engine::FieldReader& reader, double x_mm,
                                                  double y_mm) noexcept;

}  // namespace fettle::render
