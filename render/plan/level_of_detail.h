#pragma once

#include <vector>

#include "engine/field/version.h"
#include "render/plan/camera.h"
#include "shaders/layout.h"

namespace fettle::render {

/// How the samples of a field lie in the scene. A field of one row or column is drawn as if that row or
/// column stood there twice, half a spacing to both sides, so that it has cells to draw.
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

/// What to draw of a surface.
struct Detail {
  glm::ivec2 log2_stride{0, 0};     ///< columns, rows between drawn vertices
  std::vector<gpu::Patch> patches;  ///< row-major; those without any height or outside the plot left out
  std::vector<gpu::Patch> walls;    ///< rim pieces, side in place.w >> 8 as shaders/wall.vert has it
};

/// Chooses strides so that a cell is at least `cell_px` pixels large (each direction by itself, powers of
/// two), then lists the patches that can be seen. One stride for the whole field, so that neighbours meet
/// without cracks. `low_z` and `high_z` bound everything drawn [scene mm]. Cost follows the number of
/// patches.
[[nodiscard]] Detail chooseDetail(const engine::Version& field, const Placing& placing, const Camera& camera,
                                  double cell_px, double low_z, double high_z);

/// Pixels that one step of one sample in x and in y takes on the picture, at the middle of the field.
[[nodiscard]] glm::dvec2 cellPixels(const Placing& placing, const Camera& camera);

}  // namespace fettle::render
