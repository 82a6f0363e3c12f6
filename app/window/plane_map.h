#pragma once

#include <array>
#include <optional>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

namespace fettle::app {

/// Maps positions of the picture to the field's plane, where there is no surface under the cursor: outside
/// the field, over a hole. The picture of a plane is a homography in any projection; it is determined by four
/// points of which no three are on a line.
class PlaneMap {
 public:
  struct Pair {
    glm::dvec2 pixel;
    glm::dvec2 field_mm;
  };
  /// Empty when the points do not determine it: three on a line, or numbers that are not finite.
  [[nodiscard]] static std::optional<PlaneMap> through(const std::array<Pair, 4>& pairs);

  /// Empty at or above the horizon.
  [[nodiscard]] std::optional<glm::dvec2> fieldAt(const glm::dvec2& pixel) const;

 private:
  PlaneMap(const glm::dmat3& field_from_pixel, double front)
      : field_from_pixel_(field_from_pixel), front_(front) {}
  glm::dmat3 field_from_pixel_;
  double front_;  // sign of the third coordinate in front of the viewer
};

}  // namespace fettle::app
