#pragma once

#include <cstdint>
#include <span>

#include "render/vulkan/context.h"

namespace fettle::render {

/// A pass that draws on a picture: no vertices but gl_VertexIndex; viewport and scissor are dynamic.
struct PicturePass {
  std::span<const std::uint32_t> vertex, fragment;  ///< SPIR-V; no fragment shader: depth alone
  vk::PrimitiveTopology topology = vk::PrimitiveTopology::eTriangleList;
  vk::Format colour{};  ///< undefined: no colour
  vk::PipelineLayout layout;
  const vk::SpecializationInfo* constants = nullptr;  ///< of both shaders
  enum class Blend : std::uint8_t { kReplace, kPremultiplied } blend = Blend::kReplace;
  vk::Format depth_format{};  ///< undefined: no depth
  vk::PipelineDepthStencilStateCreateInfo depth{};
  std::uint32_t view_mask = 0;
};
/// Throws vk::SystemError.
[[nodiscard]] vk::raii::Pipeline makePipeline(const Context& context, const PicturePass& pass);

/// Viewport and scissor of all of a picture.
void coverAll(const vk::raii::CommandBuffer& commands, vk::Extent2D extent);

}  // namespace fettle::render
