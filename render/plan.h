#pragma once

#include <vector>

#include "engine/base/error.h"
#include "render/camera.h"
#include "render/level_of_detail.h"
#include "render/overlay.h"
#include "render/picture.h"
#include "render/value_range.h"
#include "shaders/layout.h"

namespace fettle::render {

/// One surface in a picture.
struct PanelPlan {
  Rectangle plot;  ///< pixels of the finished picture
  engine::Version field;
  Camera camera;  ///< pixels of the finished picture
  Placing placing;
  Detail detail;
  bool smooth = false;          ///< specialisation: cells larger than rays
  gpu::PanelUniforms uniforms;  ///< all but `paging.xyz`, which the field's texture knows
};

/// A picture worked out on the CPU: where everything goes and what colour it has, before any device is asked.
struct PicturePlan {
  std::vector<PanelPlan> panels;
  Layout layout;
  Furniture furniture;
  Palette palette;
  ColourMap map = ColourMap::kViridis;
  ValueRange range;
  double exaggeration = 1.0;
};

/// Heights are drawn as scene z = (height - reference) * height_unit.mm * exaggeration with the reference at
/// the middle of the robust span of both fields; spikes beyond it are cut half a span above and just over the
/// floor. Errors (kInput): a spec outside the ranges that PictureSpec and View state.
[[nodiscard]] engine::Result<PicturePlan> planPicture(const PictureSpec& spec);

/// The round factor that makes relief readable: 1 when height to width lies between 0.04 and 0.4, else what
/// brings it near 0.15 as 1, 2 or 5 times a power of ten. Both in millimetres.
[[nodiscard]] double chooseExaggeration(double relief_mm, double extent_mm);

}  // namespace fettle::render
