#include "render/vulkan/memory.h"

namespace fettle::render {

using Property = vk::MemoryPropertyFlagBits;

Buffer::Buffer(const Context& context, vk::DeviceSize bytes, vk::BufferUsageFlags usage, Access access)
    : bytes_(bytes) {
  buffer_ = vk::raii::Buffer(context.device(), {{}, bytes, usage});
  const vk::MemoryRequirements needs = buffer_.getMemoryRequirements();
  // Coherent: needs no flush. Every Vulkan device has such a type, most of them one that is cached as well.
  const vk::MemoryPropertyFlags coherent = Property::eHostVisible | Property::eHostCoherent;
  const bool cached = access == Access::kRead &&
                      context.hasMemoryType(needs.memoryTypeBits, coherent | Property::eHostCached);
  const std::uint32_t type =
      context.memoryType(needs.memoryTypeBits, cached ? coherent | Property::eHostCached : coherent);
  memory_ = vk::raii::DeviceMemory(context.device(), {needs.size, type});
  buffer_.bindMemory(*memory_, 0);
  data_ = static_cast<std::byte*>(memory_.mapMemory(0, VK_WHOLE_SIZE));
}

DeviceBuffer::DeviceBuffer(const Context& context, vk::DeviceSize bytes, vk::BufferUsageFlags usage) {
  buffer_ = vk::raii::Buffer(context.device(), {{}, bytes, usage});
  const vk::MemoryRequirements needs = buffer_.getMemoryRequirements();
  memory_ = vk::raii::DeviceMemory(
      context.device(), {needs.size, context.memoryType(needs.memoryTypeBits, Property::eDeviceLocal)});
  buffer_.bindMemory(*memory_, 0);
}

GpuImage::GpuImage(const Context& context, vk::Format format, vk::Extent2D extent, std::uint32_t layers,
                   Kind kind, vk::ImageUsageFlags usage, vk::ImageAspectFlags aspect,
                   std::optional<vk::Format> viewed_as)
    : extent_(extent), layers_(layers), aspect_(aspect) {
  vk::ImageCreateInfo info;
  info.setImageType(vk::ImageType::e2D)
      .setFormat(format)
      .setExtent({extent.width, extent.height, 1})
      .setMipLevels(1)
      .setArrayLayers(layers)
      .setUsage(usage);
  if (viewed_as) info.setFlags(vk::ImageCreateFlagBits::eMutableFormat);
  image_ = vk::raii::Image(context.device(), info);
  const vk::MemoryRequirements needs = image_.getMemoryRequirements();
  bytes_ = needs.size;
  memory_ = vk::raii::DeviceMemory(
      context.device(), {needs.size, context.memoryType(needs.memoryTypeBits, Property::eDeviceLocal)});
  image_.bindMemory(*memory_, 0);
  makeView(context, kind == Kind::kArray ? vk::ImageViewType::e2DArray : vk::ImageViewType::e2D,
           viewed_as.value_or(format));
}

GpuImage::GpuImage(const Context& context, vk::Format format, vk::Extent2D extent, vk::ImageUsageFlags usage,
                   const std::function<std::byte*(std::size_t bytes)>& memory)
    : extent_(extent), aspect_(vk::ImageAspectFlagBits::eColor) {
  constexpr auto kHost = vk::ExternalMemoryHandleTypeFlagBits::eHostAllocationEXT;
  const vk::ExternalMemoryImageCreateInfo external(kHost);
  vk::ImageCreateInfo info;
  info.setPNext(&external)
      .setImageType(vk::ImageType::e2D)
      .setFormat(format)
      .setExtent({extent.width, extent.height, 1})
      .setMipLevels(1)
      .setArrayLayers(1)
      .setTiling(vk::ImageTiling::eLinear)
      .setUsage(usage);
  image_ = vk::raii::Image(context.device(), info);
  row_bytes_ = image_.getSubresourceLayout({aspect_, 0, 0}).rowPitch;
  const vk::MemoryRequirements needs = image_.getMemoryRequirements();
  const vk::DeviceSize step = context.hostImageAlignment();
  bytes_ = (needs.size + step - 1) / step * step;
  std::byte* const at = memory(bytes_);
  const vk::MemoryHostPointerPropertiesEXT can =
      context.device().getMemoryHostPointerPropertiesEXT(kHost, at);
  const vk::ImportMemoryHostPointerInfoEXT import(kHost, at);
  vk::MemoryAllocateInfo allocation(bytes_,
                                    context.memoryType(needs.memoryTypeBits & can.memoryTypeBits, {}));
  memory_ = vk::raii::DeviceMemory(context.device(), allocation.setPNext(&import));
  image_.bindMemory(*memory_, 0);
  makeView(context, vk::ImageViewType::e2D, format);
}

void GpuImage::makeView(const Context& context, vk::ImageViewType type, vk::Format format) {
  vk::ImageViewCreateInfo view;
  view.setImage(*image_).setViewType(type).setFormat(format).setSubresourceRange(range());
  view_ = vk::raii::ImageView(context.device(), view);
}

GpuImage pictureImage(const Context& context, vk::Extent2D extent, vk::Format format) {
  using Usage = vk::ImageUsageFlagBits;
  return {context,
          format,
          extent,
          1,
          GpuImage::Kind::kPlane,
          Usage::eColorAttachment | Usage::eTransferSrc | Usage::eTransferDst,
          vk::ImageAspectFlagBits::eColor};
}

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
