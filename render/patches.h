#pragma once

#include <cstdint>
#include <vector>

#include "render/detail.h"
#include "render/level_of_detail.h"

namespace fettle::render {

/// What choosing patches looks at. `measure` belongs to the state that `reader` reads.
struct PatchQuestion {
  const DetailMeasure* measure = nullptr;
  engine::FieldReader reader;
  Placing placing;
  Camera camera;
  double mm_per_unit = 1.0;            ///< scene mm, exaggeration included, a height unit; > 0
  double reference = 0.0;              ///< height at scene z 0 [height_unit]
  double lowest = 0.0, highest = 0.0;  ///< heights that are drawn; others are cut to these [height_unit]
  double floor_z = 0.0;                ///< of the plate below; rim walls reach down to it [scene mm]
  double error_px = 1.0;
  std::int64_t vertex_budget = 98304;
};

/// The surface of one panel: leaves of a quadtree over the field, near ones first.
struct PatchChoice {
  std::vector<gpu::Patch> patches;  ///< first sample; level; level
  /// Where a patch meets one of a higher level: first sample of the edge; level | the other's level << 8;
  /// side (0 low y, 1 high x, 2 high y, 3 low x, as seen from the finer patch).
  std::vector<gpu::Patch> seams;
  std::vector<gpu::Patch> walls;  ///< along the rim, as shaders/wall.vert has it
  double bound_px = 0.0;          ///< the largest screen error of a patch
  bool within_budget = true;      ///< false when refining stopped before bound_px <= error_px
  [[nodiscard]] std::int64_t vertices() const noexcept;
  [[nodiscard]] std::int64_t triangles() const noexcept;  ///< without those of area zero
};

/// Refines the patch of the largest screen error, until all are within error_px or the budget is spent.
/// Leaves out what is outside the plot or has no height, by the min/max pyramid.
///
/// Screen error of a patch: the smaller of two bounds, each valid for every point of the fine surface over it
/// and for every point drawn:
///   - straight up or down: the deviation (detail.h), as long as it can look anywhere in the patch's box;
///   - sideways within its cell to a drawn point of the same height, and up or down by the excess.
/// Where heights of the patch are cut, the first is replaced by the range of what is left of them, since
/// cutting and interpolating do not commute. So bound_px is the Hausdorff distance on the screen between the
/// two, at most. The third part is Camera::movesAtMost, which bounds what a step can look like.
[[nodiscard]] PatchChoice choosePatches(const PatchQuestion& question);

}  // namespace fettle::render
