#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "render/plan/camera.h"

namespace fettle::render {

/// How a view becomes the camera of one panel: everything about it that does not depend on the view. With it
/// another view of the same panel can be computed, and compared with this one, before it is drawn. Plain
/// numbers: copying it costs a few hundred bytes.
struct Framing {
  Box shown;                  ///< what zoom 1 shows all of
  Box drawn;                  ///< what the depth range contains
  Rectangle plot;             ///< pixels of the finished picture
  double share = 1.0;         ///< of the plot, that zoom 1 fills
  glm::dvec2 first{0.0};      ///< scene x, y of the field's first sample [mm]
  double reference_mm = 0.0;  ///< height at scene z 0
  double exaggeration = 1.0;  ///< of heights in the scene

  [[nodiscard]] Camera camera(const View& view) const;
  /// A point of the field [mm] in the scene.
  [[nodiscard]] glm::dvec3 sceneOf(const glm::dvec3& field_mm) const noexcept {
    return {first + glm::dvec2(field_mm), (field_mm.z - reference_mm) * exaggeration};
  }
  [[nodiscard]] glm::dvec3 fieldOf(const glm::dvec3& scene) const noexcept {
    return {glm::dvec2(scene) - first, scene.z / exaggeration + reference_mm};
  }
  /// The middle of what is shown, and its longer horizontal side [mm].
  [[nodiscard]] glm::dvec3 middle() const noexcept { return 0.5 * (shown.low + shown.high); }
  [[nodiscard]] double longerSide() const noexcept;
  /// Moves the view so that a scene point is in the middle of its picture.
  void aimAt(const glm::dvec3& target, View& view) const noexcept;
  friend bool operator==(const Framing&, const Framing&) = default;
};

}  // namespace fettle::render
