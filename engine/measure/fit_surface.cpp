#include "engine/measure/fit_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

namespace fettle::engine {

namespace {

constexpr double kTiny = 1e-300;
constexpr double kFlattest = 1e-9;  // least |z| of the normal of a plane that has a height over each place

// Any direction across another one.
glm::dvec3 acrossOf(const glm::dvec3& direction) noexcept {
  const glm::dvec3 size(std::abs(direction.x), std::abs(direction.y), std::abs(direction.z));
  const glm::dvec3 other = size.x <= size.y && size.x <= size.z ? glm::dvec3(1.0, 0.0, 0.0)
                           : size.y <= size.z                   ? glm::dvec3(0.0, 1.0, 0.0)
                                                                : glm::dvec3(0.0, 0.0, 1.0);
  return glm::normalize(glm::cross(direction, other));
}

glm::dvec3 directionOr(const glm::dvec3& v, const glm::dvec3& otherwise) noexcept {
  const double length = glm::length(v);
  return length > kTiny ? v / length : otherwise;
}

// Sets radial direction and theta from the outward direction across the axis, the normal and the foot's distance from it.
void describe(FitSurface& surface, const glm::dvec3& outward, const glm::dvec3& normal, double distance) {
  const double cosine = glm::dot(normal, outward);
  const double side = cosine > 0.0 ? -1.0 : 1.0;
  surface.radial = side * outward;
  surface.ring = side / std::max(distance, kTiny);
  surface.theta = std::atan2(glm::dot(normal, surface.axial), std::abs(cosine));
}

}  // namespace

glm::dvec3 FitSurface::normal() const noexcept {
  return std::sin(theta) * axial - std::cos(theta) * radial;
}

FitSurface::At FitSurface::at(const glm::dvec3& point) const noexcept {
  // In the half plane through the axis and the point: r away from the foot, across the axis, and t along it. What is small
  // beside a large radius is never taken as a difference of radii.
  const glm::dvec3 u = point - foot;
  const double t = glm::dot(u, axial), s = std::sin(theta), c = std::cos(theta);
  const glm::dvec3 across = u - t * axial;
  const double square = glm::dot(across, across);
  const double rise = glm::dot(u, radial) + 0.5 * ring * square;
  const double big_t = std::sqrt(std::max(0.0, 1.0 + 2.0 * ring * rise)), safe_t = std::max(big_t, 1e-12);
  const double r = 2.0 * rise / (1.0 + big_t);
  // The section is a circle of curvature `tube` through the foot, or a line.
  const double g = 0.5 * tube * (r * r + t * t) + c * r - s * t;
  const double big_s = std::sqrt(std::max(0.0, 1.0 + 2.0 * tube * g)), safe_s = std::max(big_s, 1e-12);
  const double below = 2.0 * g / (1.0 + big_s);
  At at;
  at.distance = -below;
  const double by_r = (tube * r + c) / safe_s, by_t = (tube * t - s) / safe_s;
  at.gradient = -(by_r / safe_t) * (radial + ring * across) - by_t * axial;
  at.by_theta = (s * r + c * t) / safe_s;
  at.by_ring = -by_r * (square - r * r) / (2.0 * safe_t);
  at.by_tube = -(r * r + t * t - below * below) / (2.0 * safe_s);
  return at;
}

FitSurface FitSurface::of(const Shape& shape, const glm::dvec3& near) noexcept {
  FitSurface surface;
  const glm::dvec3 up(0.0, 0.0, 1.0);
  const auto upwards = [](const glm::dvec3& n) { return n.z < 0.0 ? -n : n; };
  const glm::dvec3 from = near - shape.point;
  surface.axial = shape.direction;
  const double along = glm::dot(from, shape.direction);
  const glm::dvec3 outward = directionOr(from - along * shape.direction, acrossOf(shape.direction));
  const double across = glm::dot(from, outward);
  switch (shape.kind) {
    case ShapeKind::kPlane: {
      const glm::dvec3 n = upwards(shape.direction);
      surface.foot = near - glm::dot(from, n) * n;
      surface.radial = -n;
      surface.axial = acrossOf(n);
      break;
    }
    case ShapeKind::kSphere: {
      const glm::dvec3 out = directionOr(from, up), n = upwards(out);
      surface.foot = shape.point + shape.radius * out;
      surface.tube = (glm::dot(out, n) > 0.0 ? -1.0 : 1.0) / shape.radius;
      surface.ring = surface.tube;
      surface.radial = -n;
      surface.axial = acrossOf(n);
      break;
    }
    case ShapeKind::kCylinder:
      surface.foot = shape.point + along * shape.direction + shape.radius * outward;
      describe(surface, outward, upwards(outward), shape.radius);
      break;
    case ShapeKind::kCone: {
      const double sine = std::sin(shape.half_angle), cosine = std::cos(shape.half_angle);
      const double slant =
          std::max(std::abs(along * cosine + across * sine), 1e-9 * glm::length(from) + kTiny);
      surface.foot = shape.point + slant * (sine * outward + cosine * shape.direction);
      describe(surface, outward, upwards(cosine * outward - sine * shape.direction), slant * sine);
      break;
    }
    case ShapeKind::kTorus: {
      const glm::dvec3 middle = shape.point + shape.radius * outward;
      const glm::dvec3 out = directionOr(near - middle, up), n = upwards(out);
      surface.foot = middle + shape.tube_radius * out;
      describe(surface, outward, n, std::abs(shape.radius + shape.tube_radius * glm::dot(out, outward)));
      surface.tube = (glm::dot(out, n) > 0.0 ? -1.0 : 1.0) / shape.tube_radius;
      break;
    }
  }
  return surface;
}

Shape FitSurface::shape(ShapeKind kind, const glm::dvec3& middle, const glm::dvec3& alike) const noexcept {
  Shape shape;
  shape.kind = kind;
  const glm::dvec3 n = normal();
  const double up = n.z < 0.0 ? -1.0 : 1.0;
  const auto onAxis = [&](const glm::dvec3& point) {
    return point + glm::dot(middle - point, axial) * axial;
  };
  switch (kind) {
    case ShapeKind::kPlane:
      shape.direction = up * n;
      // Not the foot of the middle: that moves along the plane with the middle's height.
      shape.point = std::abs(n.z) > kFlattest
                        ? glm::dvec3(middle.x, middle.y, middle.z + glm::dot(foot - middle, n) / n.z)
                        : middle - glm::dot(middle - foot, n) * n;
      break;
    case ShapeKind::kSphere:
      shape.point = foot + n / tube;
      shape.radius = 1.0 / std::abs(tube);
      shape.hollow = up * tube > 0.0;
      break;
    case ShapeKind::kCylinder:
      shape.point = onAxis(foot - radial / ring);
      shape.direction = glm::dot(axial, alike) < 0.0 ? -axial : axial;
      shape.radius = 1.0 / std::abs(ring);
      shape.hollow = up * ring > 0.0;
      break;
    case ShapeKind::kCone: {
      const double s = std::sin(theta), c = std::cos(theta);
      const double slant = -1.0 / (ring * s);  // from the foot along the line to the apex
      shape.point = foot + slant * (s * radial + c * axial);
      shape.direction = slant * c > 0.0 ? -axial : axial;
      shape.half_angle = std::atan2(std::abs(s), std::abs(c));
      shape.hollow = up * c / ring > 0.0;
      break;
    }
    case ShapeKind::kTorus: {
      const double s = std::sin(theta), c = std::cos(theta);
      shape.point = foot - radial / ring + (s / tube) * axial;
      shape.direction = glm::dot(axial, alike) < 0.0 ? -axial : axial;
      shape.radius = std::abs(1.0 / ring - c / tube);
      shape.tube_radius = 1.0 / std::abs(tube);
      shape.hollow = up * tube > 0.0;
      break;
    }
  }
  return shape;
}

}  // namespace fettle::engine
