#pragma once

#include "render/plan/picture.h"
#include "render/vulkan/memory.h"

namespace fettle::render {

class Context;

/// What is drawn in an image with four bytes per pixel, blue first, that is in the layout of a source of copies. Waits for the
/// device. Throws as Vulkan does. Threading: main.
[[nodiscard]] Image copyOf(const GpuImage& frame, Context& context);

}  // namespace fettle::render
