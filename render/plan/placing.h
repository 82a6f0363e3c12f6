#pragma once

#include "engine/field/version.h"
#include "render/plan/camera.h"
#include "shaders/layout.h"

namespace fettle::render {

/// Position of the samples of a field in the scene. A field of one row or column is drawn as if that row or
/// column existed twice, half a spacing to both sides, so that it has cells to draw.
struct Placing {
  glm::ivec2 true_size{1, 1};
  glm::ivec2 size{2, 2};         ///< virtual: never below 2
  glm::dvec2 first{0.0, 0.0};    ///< scene x, y of virtual sample (0, 0) [mm]
  glm::dvec2 spacing{1.0, 1.0};  ///< [mm]
  [[nodiscard]] glm::dvec2 extent() const { return spacing * glm::dvec2(size - 1); }
  friend bool operator==(const Placing&, const Placing&) = default;
};
/// The field's middle at scene (0, 0).
[[nodiscard]] Placing placingOf(const engine::Grid& grid);

/// Size of one sample step in x and in y in the picture [px], at the middle of the field; from less than three
/// degrees above the horizon as from there.
[[nodiscard]] glm::dvec2 cellPixels(const Placing& placing, const Camera& camera);

/// What shaders need of one eye: the transform from the scene to the picture, and from a pixel and its depth
/// back to a position in the field. `plot`: where the camera's picture lies in the image [px]. A second eye
/// is a second camera; everything else of a panel is the same for both.
[[nodiscard]] gpu::ViewUniforms viewOf(const Camera& camera, const Placing& placing, const Rectangle& plot);

}  // namespace fettle::render
