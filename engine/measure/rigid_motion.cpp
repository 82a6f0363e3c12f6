#include "engine/measure/rigid_motion.h"

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace fettle::engine {

namespace {

// O. Rodrigues 1840: the turn about a vector by its length.
glm::dmat3 turnBy(const glm::dvec3& vector) noexcept {
  const double angle = glm::length(vector);
  // sin(a) / a and (1 - cos a) / a^2, without the cancellation of small angles.
  const double s = angle > 1e-8 ? std::sin(angle) / angle : 1.0;
  const double half = angle > 1e-8 ? std::sin(0.5 * angle) / angle : 0.5;
  const double c = 2.0 * half * half;
  const glm::dmat3 cross(0.0, vector.z, -vector.y, -vector.z, 0.0, vector.x, vector.y, -vector.x, 0.0);
  return glm::dmat3(1.0) + s * cross + c * (cross * cross);
}

}  // namespace

glm::dvec3 RigidMotion::moved(const glm::dvec3& p) const noexcept {
  return centre + rotation * (p - centre) + shift;
}

glm::dvec3 RigidMotion::movedBack(const glm::dvec3& p) const noexcept {
  return centre + glm::transpose(rotation) * (p - centre - shift);
}

RigidMotion RigidMotion::then(const glm::dvec3& by, const glm::dvec3& turn) const noexcept {
  const glm::dmat3 more = turnBy(turn);
  return {more * rotation, more * shift + by, centre};
}

std::array<double, 16> RigidMotion::matrix() const noexcept {
  const glm::dvec3 offset = centre + shift - rotation * centre;
  std::array<double, 16> rows{};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) rows[static_cast<std::size_t>(4 * r + c)] = rotation[c][r];
    rows[static_cast<std::size_t>(4 * r + 3)] = offset[r];
  }
  rows[15] = 1.0;
  return rows;
}

RigidMotion::Angles RigidMotion::angles() const noexcept {
  constexpr double kDegree = 180.0 / std::numbers::pi;
  const glm::dvec3 normal = rotation[2];
  return {std::atan2(0.0 - normal.x, normal.z) * kDegree, std::atan2(0.0 - normal.y, normal.z) * kDegree,
          std::atan2(rotation[0].y - rotation[1].x, rotation[0].x + rotation[1].y) * kDegree};
}

}  // namespace fettle::engine
