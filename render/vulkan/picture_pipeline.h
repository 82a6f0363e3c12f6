#pragma once

#include <cstdint>
#include <span>

#include "render/vulkan/context.h"

namespace fettle::render {

/// A pass that fills all of a picture from other pictures: no vertices but gl_VertexIndex, no depth, no
/// blending; viewport and scissor are dynamic.
struct PicturePass {
  std::span<const std::uint32_t> vertex, fragment;  ///< SPIR-V
  vk::PrimitiveTopology topology = vk::PrimitiveTopology::eTriangleList;
  vk::Format colour{};
  vk::PipelineLayout layout;
  const vk::SpecializationInfo* constants = nullptr;  ///< of the fragment shader
};
/// Throws vk::SystemError.
[[nodiscard]] vk::raii::Pipeline makePipeline(const Context& context, const PicturePass& pass);

/// Viewport and scissor of all of a picture.
void coverAll(const vk::raii::CommandBuffer& commands, vk::Extent2D extent);

}  // namespace fettle::render
