#pragma once

#include <array>

#include "render/vulkan/barrier.h"

namespace fettle::render {

/// Draws a picture from one of half or twice the size each way.
///
/// Threading: as Context. Throws vk::SystemError.
class Resize {
 public:
  enum class Way {
    kEnlarge,  ///< what lies between pixels is interpolated
    kReduce,   ///< a pixel is the mean of four
  };
  /// `format`: what both pictures are read and written as. Enlarging takes code values and not amounts of
  /// light, which is a third of the work; a mean of rays is one of light.
  Resize(const Context& context, Way way, vk::Format format);
  /// Which pictures: one of twice the other's size; one layer or two each. They may no longer be in use by
  /// the ones set before.
  void set(const GpuImage& from, const GpuImage& to, std::uint32_t layers);
  /// `from` is in ShaderReadOnlyOptimal, `to` in ColorAttachmentOptimal. All of it is written.
  void record(const vk::raii::CommandBuffer& commands) const;

 private:
  const Context& context_;
  vk::Format format_;
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
  vk::Extent2D extent_;  // of what is written
};

}  // namespace fettle::render
