#pragma once

#include <array>
#include <span>

#include "render/vulkan/barrier.h"

namespace fettle::render {

/// Draws a picture at half, twice or four times the size in each direction.
///
/// Threading: as Context. Throws vk::SystemError.
class Resize {
 public:
  enum class Direction {
    kEnlarge,      ///< twice the size; pixels in between are interpolated
    kEnlargeMore,  ///< the same, four times the size
    kReduce,       ///< half the size; a pixel is the mean of four
  };
  /// `format`: of both pictures. Enlarging works on code values and not on amounts of light, which is a third
  /// of the work; reducing averages light.
  Resize(const Context& context, Direction direction, vk::Format format);
  /// Sets the pictures, one layer or two each; `to` is as large as the result, or larger. Those set before may no
  /// longer be in use.
  void set(const GpuImage& from, const GpuImage& to, std::uint32_t layers);
  /// `from` is in ShaderReadOnlyOptimal, `to` in ColorAttachmentOptimal. As much of it as the result
  /// covers is written.
  void record(const vk::raii::CommandBuffer& commands) const;
  /// The same; `parts` show the result, the rest is `outside`, as values of the format: nothing of the parts is mixed into it.
  void record(const vk::raii::CommandBuffer& commands, std::span<const vk::Rect2D> parts,
              const vk::ClearColorValue& outside) const;

 private:
  void record(const vk::raii::CommandBuffer& commands, std::span<const vk::Rect2D> parts,
              vk::AttachmentLoadOp load, const vk::ClearColorValue& outside) const;

  const Context& context_;
  Direction direction_;
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
  vk::Extent2D extent_;  // of the result
};

}  // namespace fettle::render
