#include "engine/measure/fit_relation.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>

#include "engine/measure/fit_variance.h"

namespace fettle::engine {

namespace {

constexpr double kFitUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kToDegrees = 180.0 / std::numbers::pi;

bool hasAxis(ShapeKind kind) {
  return kind == ShapeKind::kCylinder || kind == ShapeKind::kCone;
}

// Angle, distance, distance of axes, of two shapes; `middle` of the samples of each.
std::array<double, 3> relationFigures(const Shape& a, const Shape& b, const glm::dvec3& middle_a,
                                      const glm::dvec3& middle_b) {
  std::array<double, 3> figures{kFitUnknown, kFitUnknown, kFitUnknown};
  const bool plane_a = a.kind == ShapeKind::kPlane, plane_b = b.kind == ShapeKind::kPlane;
  if (a.kind != ShapeKind::kSphere && b.kind != ShapeKind::kSphere) {
    const double sine = glm::length(glm::cross(a.direction, b.direction));
    const double angle = std::atan2(sine, std::abs(glm::dot(a.direction, b.direction))) * kToDegrees;
    figures[0] = plane_a == plane_b ? angle : 90.0 - angle;
  }
  const auto placeOf = [](const Shape& s, const glm::dvec3& middle) {
    if (!hasAxis(s.kind)) return s.point;
    return s.point + glm::dot(middle - s.point, s.direction) * s.direction;
  };
  const auto fromAxis = [](const Shape& s, const glm::dvec3& p) {
    return glm::length(glm::cross(p - s.point, s.direction));
  };
  if (plane_a)
    figures[1] = glm::dot(placeOf(b, middle_b) - a.point, a.direction);
  else if (plane_b)
    figures[1] = glm::dot(placeOf(a, middle_a) - b.point, b.direction);
  else if (hasAxis(a.kind))
    figures[1] = fromAxis(a, placeOf(b, middle_b));
  else if (hasAxis(b.kind))
    figures[1] = fromAxis(b, placeOf(a, middle_a));
  else
    figures[1] = glm::length(b.point - a.point);
  if (hasAxis(a.kind) && hasAxis(b.kind)) {
    const glm::dvec3 across = glm::cross(a.direction, b.direction);
    const double sine = glm::length(across);
    if (sine > 0.0) figures[2] = std::abs(glm::dot(b.point - a.point, across)) / sine;
  }
  return figures;
}

}  // namespace

ShapeRelation relationOf(const ShapeFit& first, const ShapeFit& second) noexcept {
  const auto of = [&](const Shape& a, const Shape& b) {
    return relationFigures(a, b, first.middle, second.middle);
  };
  const std::array<double, 3> value = of(first.shape, second.shape);
  const auto by_first = figureVariances<3>(first, [&](const Shape& s) { return of(s, second.shape); });
  const auto by_second = figureVariances<3>(second, [&](const Shape& s) { return of(first.shape, s); });
  std::array<double, 3> variance{};
  for (std::size_t f = 0; f < 3; ++f) variance[f] = by_first[f] + by_second[f];
  ShapeRelation relation;
  relation.angle_deg = {value[0], std::sqrt(variance[0])};
  relation.distance_mm = {value[1], std::sqrt(variance[1])};
  relation.between_axes_mm = {value[2], std::sqrt(variance[2])};
  if (!(value[0] > 3.0 * relation.angle_deg.error)) relation.between_axes_mm = {kFitUnknown, kFitUnknown};
  return relation;
}

}  // namespace fettle::engine
