#pragma once

#include <vector>

#include "render/vulkan/memory.h"

namespace fettle::render {

using ImageLayout = vk::ImageLayout;
using Stage = vk::PipelineStageFlagBits2;
using Access = vk::AccessFlagBits2;

/// Several images whose layout changes together: earlier commands have written them, later ones may read or
/// write. One barrier for all, because a device may stop for each (lavapipe does).
class Barriers {
 public:
  struct Access {
    vk::ImageLayout layout;
    vk::PipelineStageFlags2 stages;
    vk::AccessFlags2 access;
  };
  void add(vk::Image image, const vk::ImageSubresourceRange& range, const Access& before,
           const Access& after);
  /// All layers of an image of one aspect.
  void add(vk::Image image, vk::ImageAspectFlags aspect, const Access& before, const Access& after);
  void record(const vk::raii::CommandBuffer& commands) const;

 private:
  std::vector<vk::ImageMemoryBarrier2> steps_;
};

/// The same for one image. The second form is for colour images that others own, such as a swap chain's.
void change(const vk::raii::CommandBuffer& commands, const GpuImage& image, vk::ImageLayout from,
            vk::ImageLayout to, vk::PipelineStageFlags2 before, vk::AccessFlags2 before_access,
            vk::PipelineStageFlags2 after, vk::AccessFlags2 after_access);
void change(const vk::raii::CommandBuffer& commands, vk::Image image, vk::ImageLayout from,
            vk::ImageLayout to, vk::PipelineStageFlags2 before, vk::AccessFlags2 before_access,
            vk::PipelineStageFlags2 after, vk::AccessFlags2 after_access);

}  // namespace fettle::render
