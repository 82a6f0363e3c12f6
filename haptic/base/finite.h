#pragma once

#include <cmath>

#include <glm/glm.hpp>

namespace fettle::haptic {

/// Whether every part of a vector is a number.
[[nodiscard]] inline bool finite(const glm::dvec3& v) noexcept {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace fettle::haptic
