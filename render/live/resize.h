#pragma once

#include <array>
#include <span>

#include "render/vulkan/barrier.h"

namespace fettle::render {

/// The program that Resize draws with. Threading: as Context. Throws vk::SystemError.
class ResizeProgram {
 public:
  enum class Kind { kEnlarge, kReduce };
  /// `format`: of both pictures.
  ResizeProgram(const Context& context, Kind kind, vk::Format format);

  [[nodiscard]] Kind kind() const noexcept { return kind_; }
  [[nodiscard]] vk::Format format() const noexcept { return format_; }
  [[nodiscard]] vk::DescriptorSetLayout setLayout() const noexcept { return *set_layout_; }
  [[nodiscard]] vk::PipelineLayout layout() const noexcept { return *layout_; }
  [[nodiscard]] vk::Pipeline pipeline() const noexcept { return *pipeline_; }

 private:
  const Kind kind_;
  const vk::Format format_;
  vk::raii::Sampler sampler_ = nullptr;
  vk::raii::DescriptorSetLayout set_layout_ = nullptr;
  vk::raii::PipelineLayout layout_ = nullptr;
  vk::raii::Pipeline pipeline_ = nullptr;
};

/// Draws a picture at half, twice or four times the size in each direction.
///
/// Threading: as Context. Throws vk::SystemError.
class Resize {
 public:
  enum class Times {
    kTwo,   ///< the size; enlarged, pixels in between are interpolated; reduced, a pixel is the mean of four
    kFour,  ///< enlarged only
  };
  /// The program outlives this. Enlarging works on code values and not on amounts of light, which is a third
  /// of the work; reducing averages light.
  Resize(const Context& context, const ResizeProgram& program, Times times);
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
  const ResizeProgram& program_;
  const Times times_;
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
