#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include <glm/vec3.hpp>

namespace fettle::engine {

/// The surfaces that are fitted, simpler ones first.
enum class ShapeKind : std::uint8_t { kPlane, kSphere, kCylinder, kCone, kTorus };

struct ShapeInfo {
  ShapeKind kind;
  std::string_view word;
  std::string_view text;
  int numbers = 0;  ///< that determine it
};
/// A row for each, in the order of ShapeKind.
[[nodiscard]] std::span<const ShapeInfo> shapeInfos() noexcept;
[[nodiscard]] const ShapeInfo& infoOf(ShapeKind kind) noexcept;

/// A surface in space. Lengths in millimetres, z towards the viewer of the height field.
struct Shape {
  ShapeKind kind = ShapeKind::kPlane;
  /// On the plane, of a fitted one over the mean place of the samples; centre of the sphere and of the torus; on the axis of the cylinder; apex of the cone.
  glm::dvec3 point{0.0};
  /// Of length 1. Normal of the plane, upwards; axis of the cylinder and the torus, which has no sense, in that of inAxisSense(); from the
  /// apex into the cone. Of a sphere without meaning.
  glm::dvec3 direction{0.0, 0.0, 1.0};
  double radius = 0.0;  ///< of the sphere and the cylinder; of the middle of a torus's tube about the axis
  double tube_radius = 0.0;  ///< of the torus
  double half_angle = 0.0;   ///< of the cone [rad], 0 to pi/2
  bool hollow = false;       ///< seen from inside: the centre of curvature lies above the surface
};

/// Of a direction of length 1 and its opposite, one axis, the one whose first component of at least 0.4 in size, of x, y, z, is above 0: noise
/// does not turn an axis along x, y or z, or at a multiple of 15 degrees between two of these, which all have another
/// size than 0.4. Every rule has axes that noise turns: here those at 66.4 degrees from x, of a y below 0, and the like.
[[nodiscard]] glm::dvec3 inAxisSense(const glm::dvec3& direction) noexcept;

/// The orthogonal distance of a point from a shape, above 0 where the point lies above the surface; of a cone from the line
/// through its apex that is nearest to the point. Plain arithmetic in double: an error of some 1e-15 of the point's distance
/// from the shape's point and of the radius. Any thread.
[[nodiscard]] double distanceFrom(const Shape& shape, const glm::dvec3& point) noexcept;

}  // namespace fettle::engine
