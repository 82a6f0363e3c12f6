#include "render/vulkan/capture.h"

#include <cstring>

namespace fettle::render {

void copyToHost(const vk::raii::CommandBuffer& commands, const GpuImage& from, const Buffer& to) {
  vk::BufferImageCopy copy;
  copy.setImageSubresource({vk::ImageAspectFlagBits::eColor, 0, 0, 1})
      .setImageExtent({from.extent().width, from.extent().height, 1});
  commands.copyImageToBuffer(from.image(), vk::ImageLayout::eTransferSrcOptimal, *to.handle(), copy);
  vk::MemoryBarrier2 to_host;
  to_host.setSrcStageMask(vk::PipelineStageFlagBits2::eCopy)
      .setSrcAccessMask(vk::AccessFlagBits2::eTransferWrite)
      .setDstStageMask(vk::PipelineStageFlagBits2::eHost)
      .setDstAccessMask(vk::AccessFlagBits2::eHostRead);
  vk::DependencyInfo dependency;
  dependency.setMemoryBarriers(to_host);
  commands.pipelineBarrier2(dependency);
}

Image capture(Context& context, const PictureTarget& target) {
  const vk::Extent2D extent = target.colour.extent();
  Image image;
  image.width = static_cast<int>(extent.width);
  image.height = static_cast<int>(extent.height);
  image.rgba.resize(std::size_t{4} * extent.width * extent.height);
  const Buffer out(context, image.rgba.size(), vk::BufferUsageFlagBits::eTransferDst);
  context.run([&](const vk::raii::CommandBuffer& commands) { copyToHost(commands, target.colour, out); });
  std::memcpy(image.rgba.data(), out.data(), image.rgba.size());
  return image;
}

}  // namespace fettle::render
