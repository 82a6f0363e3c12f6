#include "render/vulkan/compute_pipeline.h"

namespace fettle::render {

namespace {

using Stage2 = vk::PipelineStageFlagBits2;
using Access2 = vk::AccessFlagBits2;

void order(const vk::raii::CommandBuffer& commands, const vk::MemoryBarrier2& barrier) {
  vk::DependencyInfo dependency;
  dependency.setMemoryBarriers(barrier);
  commands.pipelineBarrier2(dependency);
}

}  // namespace

vk::raii::Pipeline makeComputePipeline(const Context& context, std::span<const std::uint32_t> words,
                                       vk::PipelineLayout layout) {
  vk::ShaderModuleCreateInfo code;
  const vk::raii::ShaderModule module(context.device(),
                                      code.setCodeSize(words.size_bytes()).setPCode(words.data()));
  vk::ComputePipelineCreateInfo info;
  info.setStage({{}, vk::ShaderStageFlagBits::eCompute, *module, "main"}).setLayout(layout);
  return {context.device(), nullptr, info};
}

void orderCompute(const vk::raii::CommandBuffer& commands) {
  const vk::PipelineStageFlags2 stages = Stage2::eComputeShader | Stage2::eTransfer;
  order(commands,
        {stages, Access2::eShaderWrite | Access2::eTransferWrite, stages,
         Access2::eShaderRead | Access2::eShaderWrite | Access2::eTransferRead | Access2::eTransferWrite});
}

void orderForHost(const vk::raii::CommandBuffer& commands) {
  order(commands, {Stage2::eTransfer, Access2::eTransferWrite, Stage2::eHost, Access2::eHostRead});
}

}  // namespace fettle::render
