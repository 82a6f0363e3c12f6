#include "render/vulkan/picture_pipeline.h"

#include <array>
#include <vector>

namespace fettle::render {

vk::raii::Pipeline makePipeline(const Context& context, const PicturePass& pass) {
  const auto module = [&](std::span<const std::uint32_t> words) {
    vk::ShaderModuleCreateInfo info;
    return vk::raii::ShaderModule(context.device(),
                                  info.setCodeSize(words.size_bytes()).setPCode(words.data()));
  };
  const vk::raii::ShaderModule vertex = module(pass.vertex);
  vk::raii::ShaderModule fragment = nullptr;
  std::vector<vk::PipelineShaderStageCreateInfo> stages{
      {{}, vk::ShaderStageFlagBits::eVertex, *vertex, "main", pass.constants}};
  if (!pass.fragment.empty()) {
    fragment = module(pass.fragment);
    stages.push_back({{}, vk::ShaderStageFlagBits::eFragment, *fragment, "main", pass.constants});
  }
  const vk::PipelineVertexInputStateCreateInfo no_vertices;
  const vk::PipelineInputAssemblyStateCreateInfo assembly{{}, pass.topology};
  const vk::PipelineViewportStateCreateInfo viewport{{}, 1, nullptr, 1, nullptr};
  vk::PipelineRasterizationStateCreateInfo raster;
  raster.setCullMode(vk::CullModeFlagBits::eNone).setLineWidth(1.0F);
  const vk::PipelineMultisampleStateCreateInfo one_sample{{}, vk::SampleCountFlagBits::e1};
  vk::PipelineColorBlendAttachmentState blend;
  using Channel = vk::ColorComponentFlagBits;
  blend.setColorWriteMask(Channel::eR | Channel::eG | Channel::eB | Channel::eA)
      .setBlendEnable(pass.blend == PicturePass::Blend::kPremultiplied)
      .setSrcColorBlendFactor(vk::BlendFactor::eOne)
      .setDstColorBlendFactor(vk::BlendFactor::eOneMinusSrcAlpha)
      .setSrcAlphaBlendFactor(vk::BlendFactor::eOne)
      .setDstAlphaBlendFactor(vk::BlendFactor::eOneMinusSrcAlpha);
  vk::PipelineColorBlendStateCreateInfo blending;
  const std::array dynamic_states{vk::DynamicState::eViewport, vk::DynamicState::eScissor};
  vk::PipelineDynamicStateCreateInfo dynamic;
  dynamic.setDynamicStates(dynamic_states);
  vk::PipelineRenderingCreateInfo rendering;
  rendering.setViewMask(pass.view_mask).setDepthAttachmentFormat(pass.depth_format);
  if (pass.colour != vk::Format::eUndefined) {
    blending.setAttachments(blend);
    rendering.setColorAttachmentFormats(pass.colour);
  }
  vk::GraphicsPipelineCreateInfo info;
  info.setStages(stages)
      .setPVertexInputState(&no_vertices)
      .setPInputAssemblyState(&assembly)
      .setPViewportState(&viewport)
      .setPRasterizationState(&raster)
      .setPMultisampleState(&one_sample)
      .setPDepthStencilState(&pass.depth)
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
