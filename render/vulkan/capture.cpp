#include "render/vulkan/capture.h"

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

}  // namespace fettle::render
