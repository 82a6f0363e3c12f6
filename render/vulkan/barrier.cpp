#include "render/vulkan/barrier.h"

namespace fettle::render {

void Barriers::add(vk::Image image, const vk::ImageSubresourceRange& range, const Access& before,
                   const Access& after) {
  vk::ImageMemoryBarrier2 step;
  step.setSrcStageMask(before.stages)
      .setSrcAccessMask(before.access)
      .setDstStageMask(after.stages)
      .setDstAccessMask(after.access)
      .setOldLayout(before.layout)
      .setNewLayout(after.layout)
      .setSrcQueueFamilyIndex(VK_QUEUE_FAMILY_IGNORED)
      .setDstQueueFamilyIndex(VK_QUEUE_FAMILY_IGNORED)
      .setImage(image)
      .setSubresourceRange(range);
  steps_.push_back(step);
}

void Barriers::add(vk::Image image, vk::ImageAspectFlags aspect, const Access& before, const Access& after) {
  add(image, {aspect, 0, 1, 0, VK_REMAINING_ARRAY_LAYERS}, before, after);
}

void Barriers::record(const vk::raii::CommandBuffer& commands) const {
  if (steps_.empty()) return;
  vk::DependencyInfo dependency;
  dependency.setImageMemoryBarriers(steps_);
  commands.pipelineBarrier2(dependency);
}

void change(const vk::raii::CommandBuffer& commands, const GpuImage& image, vk::ImageLayout from,
            vk::ImageLayout to, vk::PipelineStageFlags2 before, vk::AccessFlags2 before_access,
            vk::PipelineStageFlags2 after, vk::AccessFlags2 after_access) {
  Barriers one;
  one.add(image.image(), image.range(), {from, before, before_access}, {to, after, after_access});
  one.record(commands);
}

void change(const vk::raii::CommandBuffer& commands, vk::Image image, vk::ImageLayout from,
            vk::ImageLayout to, vk::PipelineStageFlags2 before, vk::AccessFlags2 before_access,
            vk::PipelineStageFlags2 after, vk::AccessFlags2 after_access) {
  Barriers one;
  one.add(image, vk::ImageAspectFlagBits::eColor, {from, before, before_access}, {to, after, after_access});
  one.record(commands);
}

}  // namespace fettle::render
