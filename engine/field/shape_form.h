#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include <glm/vec3.hpp>

#include "engine/field/sample_rect.h"

namespace fettle::engine {

/// The surface of a form that is a shape in space.
enum class FormShape : std::uint8_t { kSphere, kCylinder, kCone };

/// The nominal form of a surface: a part of a sphere, a circular cylinder or a circular cone, as it is seen from above.
///
/// All three are one quadric about a point q of the surface, the foot, with normal n there, d = p - q [mm]:
///
///   k |d|^2 - m (a.d)^2 = 2 n.d      sphere: m = 0; cylinder: m = k, n across a; cone: m = k / |n x a|^2
///
/// which unlike centre and radius keeps its digits where a small part of a large shape was measured. Above a place of the
/// field this is a quadratic equation for the height, whose solution with a normal upwards is taken: the only one that can be
/// seen from above.
///
/// Beyond its outline (the equator of a sphere, the two lines where a cylinder or cone is vertical; past the apex of a cone,
/// where the equation goes on) a shape has no height: there the form continues as the plane through the outline, of a sphere
/// horizontal at the height of the centre. So it has a height at every sample, without a step at the outline; it is never NaN,
/// and never farther from the foot's height than 16 times the diagonal of the field.
///
/// Heights are computed by additions, multiplications, divisions and square roots in double, which round alike everywhere:
/// the same numbers give the same bits on every machine. Error: 1e-15 of the distance from the foot and of the base, over the
/// cosine of the inclination. Any thread.
struct ShapeForm {
  FormShape shape = FormShape::kSphere;
  std::int32_t width = 1, height = 1;  ///< of the field [samples]
  double column = 0.0, row = 0.0;      ///< of the foot [samples]
  double base = 0.0;                   ///< height of the foot [height_unit]
  glm::dvec3 normal{0.0, 0.0, 1.0};    ///< at the foot, of length 1, upwards: z at least kLeastUpwards
  glm::dvec3 axis{1.0, 0.0, 0.0};      ///< of length 1; of a sphere without meaning
  double curvature = 0.0;  ///< k, across the axis at the foot [1/mm]; above 0: hollow, the centre lies above
  double spacing_x_mm = 1.0, spacing_y_mm = 1.0, height_mm = 1.0;  ///< of a column, a row, a height unit

  static constexpr double kLeastUpwards = 0.05;  ///< 87 degrees

  /// Height at sample (column, row), also between and beyond samples [height_unit].
  [[nodiscard]] double heightAt(double at_column, double at_row) const noexcept;
  /// Heights of the samples of a rectangle, row-major, `stride` >= its columns: the bits of heightAt().
  void readHeights(const SampleRect& rect, double* out, std::ptrdiff_t stride) const noexcept;
  /// Whether a place lies beyond the outline.
  [[nodiscard]] bool beyondOutline(double at_column, double at_row) const noexcept;

  /// Of a sphere and a cylinder [mm].
  [[nodiscard]] double radius() const noexcept;
  /// Of a cone [rad].
  [[nodiscard]] double halfAngle() const noexcept;
  /// The same shape about the point of its surface over a place: the same heights, but for rounding and for the bound of 16 diagonals,
  /// which counts from there. None beyond the outline, and where the normal is no longer upwards by kLeastUpwards.
  [[nodiscard]] std::optional<ShapeForm> aboutFootAt(double at_column, double at_row) const noexcept;
  /// The form of the field upside down: the heights of this one, negated.
  [[nodiscard]] ShapeForm inverted() const noexcept;
  /// Whether the numbers are such that heights can be computed: lengths of 1, a normal upwards and, of a cylinder, across the
  /// axis, no plane, and no number so large that a product is not finite.
  [[nodiscard]] bool sound() const noexcept;

  friend bool operator==(const ShapeForm&, const ShapeForm&) = default;
};

}  // namespace fettle::engine
