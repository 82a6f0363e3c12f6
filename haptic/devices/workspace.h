#pragma once

#include <cmath>
#include <cstdint>

#include <glm/vec3.hpp>

#include "haptic/devices/device.h"

namespace fettle::haptic {

/// Device millimetres to field millimetres and forces back: a uniform scale s, a rotation about z (so that
/// "away" on the desk is "into the picture" for every view direction), and a shift that the clutch moves.
///
///     field = shift + s * turn(device)           F_device = turn^-1(F_field)
///
/// Stiffness as felt. A spring of k [N/mm of the field] gives F = k * depth_field = k * s * depth_device, and
/// the force comes back unscaled, so the hand feels k_felt = s * k [N/mm of the hand]; damping likewise:
/// b_felt = s * b, since v_field = s * v_device. Limits and stability conditions are those of the device, so
/// they apply to the felt values: use fieldStiffness() for the largest value in a scene.
///
/// Why forces are not scaled: limits and smoothing strength by force are then the same at every scale. It is
/// passive as well: if a force field in the field is the gradient of a potential U, the one at the hand is
/// that of U(field) / s. (Scaling the force by s too would make the two powers equal, and k_felt = s^2 k; at
/// a scale of 0.1 nothing would be felt.)
///
/// Loop thread only; wait-free.
class Workspace {
 public:
  Workspace() = default;
  /// scale [mm of the field per mm of the device] > 0, finite; field_centre_mm is where the device's origin
  /// is.
  Workspace(double scale, const glm::dvec3& field_centre_mm, double turn_rad = 0.0) noexcept
      : scale_(scale), shift_(field_centre_mm), cos_(std::cos(turn_rad)), sin_(std::sin(turn_rad)) {}

  /// The mapping for a device whose positions are in the field already, or one that fits the ball that the
  /// device reaches to the smaller side of a field part of this size.
  [[nodiscard]] static Workspace fit(const DeviceProfile& device, const glm::dvec3& centre_mm,
                                     double side_mm) noexcept {
    if (device.space == DeviceSpace::kField) return {};
    return {side_mm / (2.0 * device.workspace_radius_mm), centre_mm};
  }

  [[nodiscard]] glm::dvec3 toField(const glm::dvec3& device_mm) const noexcept {
    return clutch_ == Clutch::kHeld ? held_ : shift_ + scale_ * turned(device_mm);
  }
  [[nodiscard]] glm::dvec3 directionToField(const glm::dvec3& device) const noexcept {
    return turned(device);
  }
  /// Zero while the clutch is held: the tip does not follow the hand then, and a force that does not change
  /// with the hand's motion would only push it.
  [[nodiscard]] glm::dvec3 forceToDevice(const glm::dvec3& field_n) const noexcept {
    if (clutch_ == Clutch::kHeld) return glm::dvec3{0.0};
    return {cos_ * field_n.x + sin_ * field_n.y, -sin_ * field_n.x + cos_ * field_n.y, field_n.z};
  }

  enum class Clutch : std::uint8_t { kReleased, kHeld };
  /// While held, the tip stays and the hand moves freely; on release the tip continues from where it stayed.
  void setClutch(Clutch clutch, const glm::dvec3& device_mm) noexcept {
    if (clutch == clutch_) return;
    if (clutch == Clutch::kHeld)
      held_ = toField(device_mm);
    else
      shift_ = held_ - scale_ * turned(device_mm);
    clutch_ = clutch;
  }

  /// Changes scale and turn without moving the tip, the device being at `device_mm`.
  void setView(double scale, double turn_rad, const glm::dvec3& device_mm) noexcept {
    const glm::dvec3 tip = toField(device_mm);
    scale_ = scale;
    cos_ = std::cos(turn_rad);
    sin_ = std::sin(turn_rad);
    shift_ = tip - scale_ * turned(device_mm);
  }

  /// Moves the mapping up with a surface that has moved: the hand stays where it is above it. [mm of the field]
  void lift(double up_mm) noexcept {
    shift_.z += up_mm;
    held_.z += up_mm;
  }

  [[nodiscard]] double scale() const noexcept { return scale_; }
  [[nodiscard]] double feltStiffness(double field_n_per_mm) const noexcept { return field_n_per_mm * scale_; }
  [[nodiscard]] double fieldStiffness(double felt_n_per_mm) const noexcept { return felt_n_per_mm / scale_; }

 private:
  [[nodiscard]] glm::dvec3 turned(const glm::dvec3& p) const noexcept {
    return {cos_ * p.x - sin_ * p.y, sin_ * p.x + cos_ * p.y, p.z};
  }

  double scale_ = 1.0;
  glm::dvec3 shift_{0.0};
  double cos_ = 1.0;
  double sin_ = 0.0;
  Clutch clutch_ = Clutch::kReleased;
  glm::dvec3 held_{0.0};
};

}  // namespace fettle::haptic
