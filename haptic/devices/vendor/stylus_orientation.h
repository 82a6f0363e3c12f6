#pragma once

#include <cmath>
#include <optional>

#include <glm/ext/quaternion_double.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

namespace fettle::haptic {

/// Turns z up to z towards the person: y becomes z. For frames in which a stylus at rest points away, and for makers' frames
/// with y up.
inline const glm::dquat kLaidDown(0.70710678118654752, 0.70710678118654752, 0.0, 0.0);

/// What a library or a service says of an orientation, of length 1; nothing when it is no rotation: numbers that are not finite, another
/// length, a mirror image. Wait-free.
[[nodiscard]] inline std::optional<glm::dquat> rotationOf(const glm::dquat& said) noexcept {
  constexpr double kRounding = 0.02;  // of what is sent as float or with few digits
  const double length = glm::length(said);
  if (!(std::abs(length - 1.0) <= kRounding)) return std::nullopt;
  return said / length;
}
[[nodiscard]] inline std::optional<glm::dquat> rotationOf(const glm::dmat3& said) noexcept {
  constexpr double kRounding = 0.02;
  for (int i = 0; i < 3; ++i) {
    if (!(std::abs(glm::length(said[i]) - 1.0) <= kRounding)) return std::nullopt;
    if (!(std::abs(glm::dot(said[i], said[(i + 1) % 3])) <= kRounding)) return std::nullopt;
  }
  if (!(glm::dot(glm::cross(said[0], said[1]), said[2]) > 0.0)) return std::nullopt;
  return rotationOf(glm::quat_cast(said));
}

}  // namespace fettle::haptic
