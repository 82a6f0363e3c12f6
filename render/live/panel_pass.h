#pragma once

#include "render/live/live_panel.h"
#include "render/vulkan/barrier.h"
#include "render/vulkan/vulkan.h"

namespace fettle::render {

// How the passes of a frame use its images.
inline constexpr auto kColour = vk::ImageAspectFlagBits::eColor;
inline constexpr auto kDepth = vk::ImageAspectFlagBits::eDepth;
inline constexpr auto kDepthStages = Stage::eEarlyFragmentTests | Stage::eLateFragmentTests;
inline constexpr auto kDepthAccess =
    Access::eDepthStencilAttachmentRead | Access::eDepthStencilAttachmentWrite;
inline constexpr auto kColourAccess = Access::eColorAttachmentRead | Access::eColorAttachmentWrite;
inline const Barriers::Access kColourWritten{ImageLayout::eColorAttachmentOptimal,
                                             Stage::eColorAttachmentOutput, Access::eColorAttachmentWrite};
inline const Barriers::Access kColourUsed{ImageLayout::eColorAttachmentOptimal, Stage::eColorAttachmentOutput,
                                          kColourAccess};

[[nodiscard]] vk::RenderingAttachmentInfo attachment(vk::ImageView view, ImageLayout layout,
                                                     vk::AttachmentLoadOp load, vk::ClearValue clear = {});

[[nodiscard]] vk::Rect2D rectOf(const Rectangle& r);

/// The pixels of a layer that a part of the picture touches; `scale`: pixels of the layer per pixel of the picture.
[[nodiscard]] Rectangle scaled(const Rectangle& r, float scale);

/// Draws panels in one pass.
class PanelDraws {
 public:
  PanelDraws(const vk::raii::CommandBuffer& commands, vk::PipelineLayout layout)
      : commands_(commands), layout_(layout) {}
  /// What follows is drawn to `part` of the panel.
  void begin(const LivePanel& panel, const Rectangle& part, float scale = 1.0F) const;
  void instances(vk::Pipeline pipeline, vk::DescriptorSet set, std::uint32_t vertices, std::size_t first,
                 std::size_t count) const;

 private:
  const vk::raii::CommandBuffer& commands_;
  vk::PipelineLayout layout_;
};

}  // namespace fettle::render
