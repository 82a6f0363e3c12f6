#pragma once

#include <cstdint>
#include <span>

#include "render/vulkan/context.h"

namespace fettle::render {

/// Throws vk::SystemError. `words`: SPIR-V of a compute shader.
[[nodiscard]] vk::raii::Pipeline makeComputePipeline(const Context& context,
                                                     std::span<const std::uint32_t> words,
                                                     vk::PipelineLayout layout);

/// What copies and compute shaders wrote before is seen by those after.
void orderCompute(const vk::raii::CommandBuffer& commands);

/// What copies wrote before is seen by the host when the commands are completed.
void orderForHost(const vk::raii::CommandBuffer& commands);

}  // namespace fettle::render
