#include "render/window/frame_copy.h"

#include <cstring>
#include <utility>

#include "render/vulkan/barrier.h"
#include "render/vulkan/context.h"

namespace fettle::render {

Image copyOf(const GpuImage& frame, Context& context) {
  const vk::Extent2D extent = frame.extent();
  const std::size_t bytes = std::size_t{4} * extent.width * extent.height;
  const Buffer buffer(context, bytes, vk::BufferUsageFlagBits::eTransferDst);
  context.run([&](const vk::raii::CommandBuffer& commands) {
    vk::BufferImageCopy copy;
    copy.setImageSubresource({vk::ImageAspectFlagBits::eColor, 0, 0, 1})
        .setImageExtent({extent.width, extent.height, 1});
    commands.copyImageToBuffer(frame.image(), ImageLayout::eTransferSrcOptimal, *buffer.handle(), copy);
    vk::MemoryBarrier2 barrier;
    barrier.setSrcStageMask(Stage::eCopy)
        .setSrcAccessMask(Access::eTransferWrite)
        .setDstStageMask(Stage::eHost)
        .setDstAccessMask(Access::eHostRead);
    vk::DependencyInfo info;
    commands.pipelineBarrier2(info.setMemoryBarriers(barrier));
  });
  Image image{static_cast<int>(extent.width), static_cast<int>(extent.height), {}};
  image.rgba.resize(bytes);
  std::memcpy(image.rgba.data(), buffer.data(), bytes);
  for (std::size_t i = 0; i < bytes; i += 4) {
    std::swap(image.rgba[i], image.rgba[i + 2]);
    image.rgba[i + 3] = 255;
  }
  return image;
}

}  // namespace fettle::render
