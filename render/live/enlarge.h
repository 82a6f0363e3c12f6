#pragma once

#include <array>

#include "render/vulkan/barrier.h"

namespace fettle::render {

/// Draws a picture from one of half the size each way: what lies between its pixels is interpolated, between
/// code values and not between amounts of light, which is a third of the work.
///
/// Threading: as Context. Throws vk::SystemError.
class Enlarge {
 public:
  /// `codes`: format of both pictures, as code values.
  Enlarge(const Context& context, vk::Format codes);
  /// Which pictures: of one size, a multiple of two, and half of that; one layer or two each. They may no
  /// longer be in use by the ones set before.
  void set(const GpuImage& small, const GpuImage& large, std::uint32_t layers);
  /// `small` is in ShaderReadOnlyOptimal, `large` in ColorAttachmentOptimal. All of it is written.
  void record(const vk::raii::CommandBuffer& commands) const;

 private:
  const Context& context_;
  vk::Format codes_;
  vk::raii::Sampler sampler_ = nullptr;
  vk::raii::DescriptorSetLayout set_layout_ = nullptr;
  vk::raii::PipelineLayout layout_ = nullptr;
  vk::raii::Pipeline pipeline_ = nullptr;
  vk::raii::DescriptorPool pool_ = nullptr;
  struct Layer {
    vk::raii::ImageView from = nullptr, to = nullptr;
    vk::raii::DescriptorSet set = nullptr;
  };
  std::array<Layer, 2> layers_;
  std::uint32_t count_ = 0;
  vk::Extent2D extent_;  // of the large one
};

}  // namespace fettle::render
