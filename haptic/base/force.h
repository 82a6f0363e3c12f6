#pragma once

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/glm.hpp>
#include <glm/vec3.hpp>

namespace fettle::haptic {

/// Whether every part of a vector is a number.
[[nodiscard]] inline bool finite(const glm::dvec3& v) noexcept {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// A force [N] cut to the limit [N] along its own direction.
struct ClampedForce {
  glm::dvec3 force_n{0.0};
  double strength = 0.0;  ///< |force| / limit, 0 .. 1
  bool clamped = false;
};

/// Limits a force before it is sent to the device: the last check in that chain. A force that is not finite
/// becomes zero and counts as clamped. `limit_n` > 0.
[[nodiscard]] inline ClampedForce clampForce(const glm::dvec3& force_n, double limit_n) noexcept {
  // Scaled by the largest component, so that squares neither overflow nor vanish.
  if (!std::isfinite(force_n.x + force_n.y + force_n.z)) return {glm::dvec3(0.0), 0.0, true};
  const double largest = std::max({std::abs(force_n.x), std::abs(force_n.y), std::abs(force_n.z)});
  if (!(largest > 0.0)) return {};
  const glm::dvec3 scaled = force_n / largest;
  const double size = glm::length(scaled);  // 1 .. sqrt(3)
  if (largest * size > limit_n) return {scaled * (limit_n / size), 1.0, true};
  return {force_n, largest * size / limit_n, false};
}

}  // namespace fettle::haptic
