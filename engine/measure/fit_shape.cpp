#include "engine/measure/fit_shape.h"

#include <cmath>
#include <cstddef>
#include <iterator>

#include <glm/geometric.hpp>

#include "engine/base/rows.h"

namespace fettle::engine {

namespace {

constexpr ShapeInfo kShapes[] = {
    {ShapeKind::kPlane, "plane", "a plane", 3},
    {ShapeKind::kSphere, "sphere", "a sphere", 4},
    {ShapeKind::kCylinder, "cylinder", "a circular cylinder", 5},
    {ShapeKind::kCone, "cone", "a circular cone", 6},
    {ShapeKind::kTorus, "torus", "a ring of circular section", 7},
};
static_assert(inOrder(kShapes, &ShapeInfo::kind, static_cast<ShapeKind>(std::size(kShapes))));

}  // namespace

std::span<const ShapeInfo> shapeInfos() noexcept {
  return kShapes;
}

const ShapeInfo& infoOf(ShapeKind kind) noexcept {
  return kShapes[static_cast<std::size_t>(kind)];
}

glm::dvec3 inAxisSense(const glm::dvec3& direction) noexcept {
  constexpr double kSure = 0.4;  // less than the root of a third, which one of three has at least
  for (const double component : {direction.x, direction.y, direction.z})
    if (std::abs(component) >= kSure) return component < 0.0 ? -direction : direction;
  return direction;
}

double distanceFrom(const Shape& shape, const glm::dvec3& point) noexcept {
  const glm::dvec3 from = point - shape.point;
  const double along = glm::dot(from, shape.direction);
  const double across = glm::length(from - along * shape.direction);
  const double sign = shape.hollow ? -1.0 : 1.0;
  switch (shape.kind) {
    case ShapeKind::kPlane:
      return along;
    case ShapeKind::kSphere:
      return sign * (glm::length(from) - shape.radius);
    case ShapeKind::kCylinder:
      return sign * (across - shape.radius);
    case ShapeKind::kCone:
      return sign * (across * std::cos(shape.half_angle) - along * std::sin(shape.half_angle));
    case ShapeKind::kTorus:
      return sign * (std::hypot(across - shape.radius, along) - shape.tube_radius);
  }
  return 0.0;
}

}  // namespace fettle::engine
