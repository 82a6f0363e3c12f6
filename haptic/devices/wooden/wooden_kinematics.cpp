#include "haptic/devices/wooden/wooden_kinematics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/glm.hpp>

namespace fettle::haptic {

namespace {

double sign(const WoodenConfig& c, int body) noexcept {
  return c.motor_and_body_aligned[static_cast<std::size_t>(body)] ? -1.0 : 1.0;
}

double reduction(const WoodenConfig& c, int body) noexcept {
  return c.diameter_capstan_m[body] / c.diameter_body_m[body];
}

}  // namespace

glm::dvec3 woodenAngles(const WoodenConfig& c, const std::array<std::int32_t, 3>& counts) noexcept {
  glm::dvec3 angles;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    angles[i] = sign(c, i) * 2.0 * std::numbers::pi * counts[k] / c.cpr_encoder[k] * reduction(c, i);
  }
  return angles;
}

glm::dvec3 woodenPosition(const WoodenConfig& c, const glm::dvec3& t) noexcept {
  const glm::dvec3& l = c.length_body_m;
  const double r = l.y * std::sin(t.y) + l.z * std::sin(t.z);
  return glm::dvec3{std::cos(t.x) * r, std::sin(t.x) * r, l.x + l.y * std::cos(t.y) - l.z * std::cos(t.z)} -
         c.workspace_origin_m;
}

glm::dmat3 woodenJacobian(const WoodenConfig& c, const glm::dvec3& t) noexcept {
  const glm::dvec3& l = c.length_body_m;
  const double r = l.y * std::sin(t.y) + l.z * std::sin(t.z);
  const double ca = std::cos(t.x);
  const double sa = std::sin(t.x);
  return {glm::dvec3{-sa * r, ca * r, 0.0},
          l.y * glm::dvec3{ca * std::cos(t.y), sa * std::cos(t.y), -std::sin(t.y)},
          l.z * glm::dvec3{ca * std::cos(t.z), sa * std::cos(t.z), std::sin(t.z)}};
}

glm::dvec3 woodenTorques(const WoodenConfig& c, const glm::dvec3& angles, const glm::dvec3& force) noexcept {
  const glm::dmat3 j = woodenJacobian(c, angles);
  return {glm::dot(j[0], force), glm::dot(j[1], force), glm::dot(j[2], force)};
}

glm::dvec3 woodenCurrents(const WoodenConfig& c, const glm::dvec3& torques) noexcept {
  glm::dvec3 ma;
  for (int i = 0; i < 3; ++i)
    ma[i] = 1000.0 * sign(c, i) * torques[i] * reduction(c, i) / c.torque_constant_nm_a[i];
  return ma;
}

LimitedCurrents limitCurrents(const WoodenConfig& c, const glm::dvec3& ma) noexcept {
  double scale = 1.0;
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(ma[i])) return {glm::dvec3{0.0}, 0.0};
    const double limit = 1000.0 * c.max_current_a[i];
    if (std::abs(ma[i]) > limit) scale = std::min(scale, limit / std::abs(ma[i]));
  }
  return {ma * scale, scale};
}

}  // namespace fettle::haptic
