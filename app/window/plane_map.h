#pragma once

#include <array>
#include <optional>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

namespace fettle::app {

/// Takes places of the picture to the field's plane, where there is no surface to point at: next to the field,
/// over a hole. A picture of a plane is a homography, whatever the projection; four points that lie on no
/// common line, three by three, say which.
class PlaneMap {
 public:
  struct Pair {
    glm::dvec2 pixel;
    glm::dvec2 field_mm;
  };
  /// Empty when the points do not say: three on a line, or numbers that are not finite.
  [[nodiscard]] static std::optional<PlaneMap> through(const std::array<Pair, 4>& pairs);

  /// Empty at or above the horizon.
  [[nodiscard]] std::optional<glm::dvec2> fieldAt(const glm::dvec2& pixel) const;

 private:
  PlaneMap(const glm::dmat3& field_from_pixel, double front)
      : field_from_pixel_(field_from_pixel), front_(front) {}
  glm::dmat3 field_from_pixel_;
  double front_;  // sign of the third coordinate before the viewer
};

}  // namespace fettle::app
