#pragma once

#include "render/vulkan/vulkan.h"

#define XR_USE_GRAPHICS_API_VULKAN
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

namespace fettle::render {

/// A structure of OpenXR of its type, and zero otherwise.
template <class Structure>
[[nodiscard]] Structure typed(XrStructureType type) noexcept {
  Structure structure{};
  structure.type = type;
  return structure;
}

}  // namespace fettle::render
