#pragma once

#include <array>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace fettle::engine {

/// A rotation and a shift in space: p becomes centre + rotation (p - centre) + shift [mm].
struct RigidMotion {
  glm::dmat3 rotation{1.0};
  glm::dvec3 shift{0.0};
  glm::dvec3 centre{0.0};

  [[nodiscard]] glm::dvec3 moved(const glm::dvec3& p) const noexcept;
  /// The point that is moved to p.
  [[nodiscard]] glm::dvec3 movedBack(const glm::dvec3& p) const noexcept;
  /// This motion, then a turn about the centre by the vector `turn` (its length is the angle [rad]) and a shift `by`.
  [[nodiscard]] RigidMotion then(const glm::dvec3& by, const glm::dvec3& turn) const noexcept;
  /// Row-major 4 x 4 matrix of homogeneous coordinates.
  [[nodiscard]] std::array<double, 16> matrix() const noexcept;

  /// What the turn does to a level surface [degrees]: how it is tilted up to higher x and higher y, and its rotation about z,
  /// anticlockwise seen from above.
  struct Angles {
    double tilt_x = 0.0, tilt_y = 0.0, rotation_z = 0.0;
  };
  [[nodiscard]] Angles angles() const noexcept;
};

}  // namespace fettle::engine
