#pragma once

#include "render/plan/placing.h"
#include "shaders/layout.h"

namespace fettle::render {

/// What shaders need of one eye: the transform from the scene to the picture, and from a pixel and its depth
/// back to a position in the field. `plot`: where the camera's picture lies in the image [px]. A second eye
/// is a second camera; everything else of a panel is the same for both.
[[nodiscard]] gpu::ViewUniforms viewOf(const Camera& camera, const Placing& placing, const Rectangle& plot);

}  // namespace fettle::render
