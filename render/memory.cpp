#include "render/memory.h"

namespace fettle::render {

using Property = vk::MemoryPropertyFlagBits;

Buffer::Buffer(const Context& context, vk::DeviceSize bytes, vk::BufferUsageFlags usage) : bytes_(bytes) {
  buffer_ = vk::raii::Buffer(context.device(), {{}, bytes, usage});
  const vk::MemoryRequirements needs = buffer_.getMemoryRequirements();
  // Coherent: no flush to forget. Every Vulkan device has such a type.
  const std::uint32_t type =
      context.memoryType(needs.memoryTypeBits, Property::eHostVisible | Property::eHostCoherent);
  memory_ = vk::raii::DeviceMemory(context.device(), {needs.size, type});
  buffer_.bindMemory(*memory_, 0);
  data_ = static_cast<std::byte*>(memory_.mapMemory(0, VK_WHOLE_SIZE));
}

GpuImage::GpuImage(const Context& context, vk::Format format, vk::Extent2D extent, std::uint32_t layers,
                   Kind kind, vk::ImageUsageFlags usage, vk::ImageAspectFlags aspect)
    : extent_(extent), layers_(layers), aspect_(aspect) {
  vk::ImageCreateInfo info;
  info.setImageType(vk::ImageType::e2D)
      .setFormat(format)
      .setExtent({extent.width, extent.height, 1})
      .setMipLevels(1)
      .setArrayLayers(layers)
      .setUsage(usage);
  image_ = vk::raii::Image(context.device(), info);
  const vk::MemoryRequirements needs = image_.getMemoryRequirements();
  bytes_ = needs.size;
  memory_ = vk::raii::DeviceMemory(
      context.device(), {needs.size, context.memoryType(needs.memoryTypeBits, Property::eDeviceLocal)});
  image_.bindMemory(*memory_, 0);
  vk::ImageViewCreateInfo view;
  view.setImage(*image_)
      .setViewType(kind == Kind::kArray ? vk::ImageViewType::e2DArray : vk::ImageViewType::e2D)
      .setFormat(format)
      .setSubresourceRange(range());
  view_ = vk::raii::ImageView(context.device(), view);
}

namespace {

void barrier(const vk::raii::CommandBuffer& commands, vk::Image image, const vk::ImageSubresourceRange& range,
             vk::ImageLayout from, vk::ImageLayout to, vk::PipelineStageFlags2 before,
             vk::AccessFlags2 before_access, vk::PipelineStageFlags2 after, vk::AccessFlags2 after_access) {
  vk::ImageMemoryBarrier2 step;
  step.setSrcStageMask(before)
      .setSrcAccessMask(before_access)
      .setDstStageMask(after)
      .setDstAccessMask(after_access)
      .setOldLayout(from)
      .setNewLayout(to)
      .setSrcQueueFamilyIndex(VK_QUEUE_FAMILY_IGNORED)
      .setDstQueueFamilyIndex(VK_QUEUE_FAMILY_IGNORED)
      .setImage(image)
      .setSubresourceRange(range);
  vk::DependencyInfo dependency;
  dependency.setImageMemoryBarriers(step);
  commands.pipelineBarrier2(dependency);
}

}  // namespace

void change(const vk::raii::CommandBuffer& commands, const GpuImage& image, vk::ImageLayout from,
            vk::ImageLayout to, vk::PipelineStageFlags2 before, vk::AccessFlags2 before_access,
            vk::PipelineStageFlags2 after, vk::AccessFlags2 after_access) {
  barrier(commands, image.image(), image.range(), from, to, before, before_access, after, after_access);
}

void change(const vk::raii::CommandBuffer& commands, vk::Image image, vk::ImageLayout from,
            vk::ImageLayout to, vk::PipelineStageFlags2 before, vk::AccessFlags2 before_access,
            vk::PipelineStageFlags2 after, vk::AccessFlags2 after_access) {
  barrier(commands, image, {vk::ImageAspectFlagBits::eColor, 0, 1, 0, VK_REMAINING_ARRAY_LAYERS}, from, to,
          before, before_access, after, after_access);
}

}  // namespace fettle::render
