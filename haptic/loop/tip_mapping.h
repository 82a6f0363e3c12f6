#pragma once

#include <glm/vec3.hpp>

namespace fettle::haptic {

/// Where the device's ball of millimetres lies in the field, as one tick applies it: uniform and without
/// rotation, so that angles and directions are felt as they are.
///
///   field = field_at_origin_mm + scale * device        force on the hand = force_scale * force of the scene
///
/// With force_scale 1 the stiffness as felt is scale * the scene's, since a millimetre of hand is `scale`
/// millimetres of field; with force_scale = 1 / scale it is the scene's own.
struct TipMapping {
  glm::dvec3 field_at_origin_mm{0.0};
  double scale = 1.0;        ///< field millimetres a device millimetre, > 0
  double force_scale = 1.0;  ///< > 0

  [[nodiscard]] glm::dvec3 toField(const glm::dvec3& device_mm) const noexcept {
    return field_at_origin_mm + scale * device_mm;
  }
  [[nodiscard]] glm::dvec3 toDevice(const glm::dvec3& force_n) const noexcept {
    return force_scale * force_n;
  }
};

}  // namespace fettle::haptic
