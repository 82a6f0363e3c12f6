#include "render/vulkan/picture_pipeline.h"

#include <array>

namespace fettle::render {

vk::raii::Pipeline makePipeline(const Context& context, const PicturePass& pass) {
  const auto module = [&](std::span<const std::uint32_t> words) {
    vk::ShaderModuleCreateInfo info;
    return vk::raii::ShaderModule(context.device(),
                                  info.setCodeSize(words.size_bytes()).setPCode(words.data()));
  };
  const vk::raii::ShaderModule vertex = module(pass.vertex), fragment = module(pass.fragment);
  const std::array stages{
      vk::PipelineShaderStageCreateInfo{{}, vk::ShaderStageFlagBits::eVertex, *vertex, "main"},
      vk::PipelineShaderStageCreateInfo{
          {}, vk::ShaderStageFlagBits::eFragment, *fragment, "main", pass.constants}};
  const vk::PipelineVertexInputStateCreateInfo no_vertices;
  const vk::PipelineInputAssemblyStateCreateInfo assembly{{}, pass.topology};
  const vk::PipelineViewportStateCreateInfo viewport{{}, 1, nullptr, 1, nullptr};
  vk::PipelineRasterizationStateCreateInfo raster;
  raster.setCullMode(vk::CullModeFlagBits::eNone).setLineWidth(1.0F);
  const vk::PipelineMultisampleStateCreateInfo one_sample{{}, vk::SampleCountFlagBits::e1};
  vk::PipelineColorBlendAttachmentState write;
  using Channel = vk::ColorComponentFlagBits;
  write.setColorWriteMask(Channel::eR | Channel::eG | Channel::eB | Channel::eA);
  vk::PipelineColorBlendStateCreateInfo blending;
  blending.setAttachments(write);
  const std::array dynamic_states{vk::DynamicState::eViewport, vk::DynamicState::eScissor};
  vk::PipelineDynamicStateCreateInfo dynamic;
  dynamic.setDynamicStates(dynamic_states);
  vk::PipelineRenderingCreateInfo rendering;
  rendering.setColorAttachmentFormats(pass.colour);
  vk::GraphicsPipelineCreateInfo info;
  info.setStages(stages)
      .setPVertexInputState(&no_vertices)
      .setPInputAssemblyState(&assembly)
      .setPViewportState(&viewport)
      .setPRasterizationState(&raster)
      .setPMultisampleState(&one_sample)
      .setPColorBlendState(&blending)
      .setPDynamicState(&dynamic)
      .setLayout(pass.layout)
      .setPNext(&rendering);
  return {context.device(), nullptr, info};
}

void coverAll(const vk::raii::CommandBuffer& commands, vk::Extent2D extent) {
  commands.setViewport(0, vk::Viewport{0.0F, 0.0F, static_cast<float>(extent.width),
                                       static_cast<float>(extent.height), 0.0F, 1.0F});
  commands.setScissor(0, vk::Rect2D{{0, 0}, extent});
}

}  // namespace fettle::render
