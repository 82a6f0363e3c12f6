#pragma once

#include "render/vulkan/memory.h"

namespace fettle::render {

inline constexpr vk::Format kColourFormat = vk::Format::eR8G8B8A8Srgb;  // blends and filters in linear light
inline constexpr vk::Format kDepthFormat = vk::Format::eD32Sfloat;

/// A target is drawn to in one or more submissions: each begins and ends, the last one also finishes.
enum class Pass {
  kFirst,  ///< clears
  kNext,   ///< goes on with what the submission before left
};

/// Where a panel is drawn at several rays a pixel: premultiplied colour and depth, read by the picture
/// afterwards.
struct SceneTarget {
  GpuImage colour, depth;
  SceneTarget() = default;
  SceneTarget(const Context& context, vk::Extent2D extent);
  /// Starts drawing, at first transparent and farthest depth. After finish() the colour can be sampled.
  void begin(const vk::raii::CommandBuffer& commands, Pass pass) const;
  void end(const vk::raii::CommandBuffer& commands) const;
  void finish(const vk::raii::CommandBuffer& commands) const;
};

/// The finished picture off-screen, ready to be copied out after finish(). A window's target has the same
/// calls on an image of its swap chain.
struct PictureTarget {
  GpuImage colour;
  PictureTarget() = default;
  PictureTarget(const Context& context, vk::Extent2D extent);
  /// `ground`: linear red, green, blue.
  void begin(const vk::raii::CommandBuffer& commands, const std::array<float, 3>& ground, Pass pass) const;
  void end(const vk::raii::CommandBuffer& commands) const;
  void finish(const vk::raii::CommandBuffer& commands) const;
};

}  // namespace fettle::render
