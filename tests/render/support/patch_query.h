#pragma once

#include "engine/field/version.h"
#include "render/detail/detail.h"
#include "render/detail/patches.h"
#include "render/plan/camera.h"
#include "render/plan/placing.h"

namespace fettle::render {

/// The plot of queryOver() [px].
inline constexpr Rectangle kQueryPlot{0, 0, 900, 600};

/// Sees all of a field with heights between -1 and 1 mm, 0.2 mm above a floor.
inline Camera cameraOver(const engine::Version& field, const View& view) {
  const glm::dvec2 half = 0.5 * placingOf(field.grid()).extent();
  const Box box{{-half.x, -half.y, -1.2}, {half.x, half.y, 1.0}};
  return Camera::fit(view, box, box, kQueryPlot);
}

/// The patches of such a field in that plot, to half a pixel; `measure` is of the field, measured or not.
inline PatchQuery queryOver(const engine::Version& field, const DetailMeasure& measure,
                            const View& view = {}) {
  PatchQuery q;
  q.measure = &measure;
  q.reader = field.reader();
  q.placing = placingOf(field.grid());
  q.lowest = -1.0, q.highest = 1.0, q.floor_z = -1.2, q.error_px = 0.5;
  q.camera = cameraOver(field, view);
  return q;
}

}  // namespace fettle::render
