#pragma once

#include <array>
#include <cstdint>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "haptic/devices/wooden/wooden_config.h"

namespace fettle::haptic {

/// Geometry of a WoodenHaptics device in its maker's own frame: x towards the user, y right, z up; metres,
/// radians. All functions are pure, allocate nothing and run in about 100 ns: the loop thread may call them.
/// Source: the makers' published kinematics (WoodenHaptics/woody-experimental, CWoodenDevice).

/// Body angles from encoder counts (unwrapped, home pose already in them): theta_i = s_i 2 pi enc_i / cpr_i
/// * d_capstan_i / d_body_i, s = -1 where motor and body are aligned.
[[nodiscard]] glm::dvec3 woodenAngles(const WoodenConfig& config,
                                      const std::array<std::int32_t, 3>& counts) noexcept;

/// Stylus position from the workspace origin [m].
[[nodiscard]] glm::dvec3 woodenPosition(const WoodenConfig& config, const glm::dvec3& angles) noexcept;

/// J: column i = change of position with angle i [m/rad].
[[nodiscard]] glm::dmat3 woodenJacobian(const WoodenConfig& config, const glm::dvec3& angles) noexcept;

/// Body torques that hold a force against the hand [Nm] = transpose(J) force.
[[nodiscard]] glm::dvec3 woodenTorques(const WoodenConfig& config, const glm::dvec3& angles,
                                       const glm::dvec3& force_n) noexcept;

/// Motor currents for body torques [mA]: s_i tau_i (d_capstan_i / d_body_i) / kt_i.
[[nodiscard]] glm::dvec3 woodenCurrents(const WoodenConfig& config, const glm::dvec3& torques_nm) noexcept;

/// Currents within the motors' limits: all three scaled by one factor <= 1, so that the force keeps its
/// direction (clamping each alone would change it). Non-finite currents give zero.
struct LimitedCurrents {
  glm::dvec3 ma{0.0};
  double scale = 1.0;  ///< < 1: the limit was active
};
[[nodiscard]] LimitedCurrents limitCurrents(const WoodenConfig& config, const glm::dvec3& ma) noexcept;

/// Maker's frame to DeviceSpace::kDesk and back: a turn about z, lengths kept.
[[nodiscard]] inline glm::dvec3 woodenToDesk(const glm::dvec3& v) noexcept {
  return {v.y, -v.x, v.z};
}
[[nodiscard]] inline glm::dvec3 deskToWooden(const glm::dvec3& v) noexcept {
  return {-v.y, v.x, v.z};
}

}  // namespace fettle::haptic
