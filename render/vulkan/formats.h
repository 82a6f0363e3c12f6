#pragma once

#include "render/vulkan/vulkan.h"

namespace fettle::render {

inline constexpr vk::Format kColourFormat = vk::Format::eR8G8B8A8Srgb;  // blends and filters in linear light
inline constexpr vk::Format kDepthFormat = vk::Format::eD32Sfloat;

}  // namespace fettle::render
