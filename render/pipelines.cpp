#include "render/pipelines.h"

#include <array>
#include <span>

#include "floor.frag.h"
#include "floor.vert.h"
#include "line.frag.h"
#include "line.vert.h"
#include "quad.frag.h"
#include "quad.vert.h"
#include "seam.vert.h"
#include "shaders/layout.h"
#include "surface.frag.h"
#include "surface.vert.h"
#include "wall.frag.h"
#include "wall.vert.h"

namespace fettle::render {
namespace {

using Words = std::span<const std::uint32_t>;
using Stage = vk::ShaderStageFlagBits;

vk::DescriptorSetLayoutBinding binding(int number, vk::DescriptorType type) {
  return {static_cast<std::uint32_t>(number), type, 1, Stage::eVertex | Stage::eFragment};
}

}  // namespace

// What differs between the pipelines.
struct Pipelines::Recipe {
  Words vertex, fragment;
  vk::PipelineLayout layout;
  vk::PrimitiveTopology topology = vk::PrimitiveTopology::eTriangleStrip;
  enum class Depth { kTestAndWrite, kTest, kIgnore, kNone } depth = Depth::kTestAndWrite;
  enum class Blend { kReplace, kPremultiplied } blend = Blend::kReplace;
  std::array<vk::Bool32, gpu::kSpecCount> constants{};  // by constant_id
};

Pipelines::Pipelines(const Context& context, vk::Format colour) : context_(context), colour_(colour) {
  const std::array scene{binding(gpu::kBindPanel, vk::DescriptorType::eUniformBuffer),
                         binding(gpu::kBindHeights, vk::DescriptorType::eSampledImage),
                         binding(gpu::kBindMarks, vk::DescriptorType::eSampledImage),
                         binding(gpu::kBindOriginal, vk::DescriptorType::eSampledImage),
                         binding(gpu::kBindPatches, vk::DescriptorType::eStorageBuffer),
                         binding(gpu::kBindShade, vk::DescriptorType::eSampledImage),
                         binding(gpu::kBindLines, vk::DescriptorType::eStorageBuffer),
                         binding(gpu::kBindPages, vk::DescriptorType::eUniformTexelBuffer)};
  const std::array picture{binding(gpu::kBindScene, vk::DescriptorType::eSampledImage),
                           binding(gpu::kBindGlyphs, vk::DescriptorType::eSampledImage),
                           binding(gpu::kBindQuads, vk::DescriptorType::eStorageBuffer),
                           binding(gpu::kBindMap, vk::DescriptorType::eUniformBuffer)};
  vk::DescriptorSetLayoutCreateInfo set;
  scene_set_ = vk::raii::DescriptorSetLayout(context.device(), set.setBindings(scene));
  picture_set_ = vk::raii::DescriptorSetLayout(context.device(), set.setBindings(picture));
  vk::PipelineLayoutCreateInfo layout;
  const vk::PushConstantRange push{Stage::eVertex, 0, sizeof(gpu::vec4)};
  scene_layout_ = vk::raii::PipelineLayout(context.device(),
                                           layout.setSetLayouts(*scene_set_).setPushConstantRanges(push));
  picture_layout_ = vk::raii::PipelineLayout(context.device(),
                                             layout.setSetLayouts(*picture_set_).setPushConstantRanges(push));
}

vk::raii::Pipeline Pipelines::make(const Recipe& recipe) {
  const auto module = [&](Words words) {
    vk::ShaderModuleCreateInfo info;
    return vk::raii::ShaderModule(context_.device(),
                                  info.setCodeSize(words.size_bytes()).setPCode(words.data()));
  };
  const vk::raii::ShaderModule vertex = module(recipe.vertex), fragment = module(recipe.fragment);
  std::array<vk::SpecializationMapEntry, gpu::kSpecCount> entries;
  for (std::uint32_t i = 0; i < entries.size(); ++i)
    entries[i] =
        vk::SpecializationMapEntry{i, i * static_cast<std::uint32_t>(sizeof(vk::Bool32)), sizeof(vk::Bool32)};
  vk::SpecializationInfo constants;
  constants.setMapEntries(entries).setDataSize(sizeof(recipe.constants)).setPData(recipe.constants.data());
  const std::array stages{
      vk::PipelineShaderStageCreateInfo{{}, Stage::eVertex, *vertex, "main", &constants},
      vk::PipelineShaderStageCreateInfo{{}, Stage::eFragment, *fragment, "main", &constants}};

  const vk::PipelineVertexInputStateCreateInfo no_vertices;
  const vk::PipelineInputAssemblyStateCreateInfo assembly{{}, recipe.topology};
  const vk::PipelineViewportStateCreateInfo viewport{{}, 1, nullptr, 1, nullptr};
  vk::PipelineRasterizationStateCreateInfo raster;
  raster.setCullMode(vk::CullModeFlagBits::eNone).setLineWidth(1.0F);
  const vk::PipelineMultisampleStateCreateInfo one_sample{{}, vk::SampleCountFlagBits::e1};
  vk::PipelineDepthStencilStateCreateInfo depth;
  const bool writes = recipe.depth == Recipe::Depth::kTestAndWrite;
  depth.setDepthTestEnable(writes || recipe.depth == Recipe::Depth::kTest)
      .setDepthWriteEnable(writes)
      .setDepthCompareOp(vk::CompareOp::eLessOrEqual);
  vk::PipelineColorBlendAttachmentState blend;
  using Channel = vk::ColorComponentFlagBits;
  blend.setColorWriteMask(Channel::eR | Channel::eG | Channel::eB | Channel::eA)
      .setBlendEnable(recipe.blend == Recipe::Blend::kPremultiplied)
      .setSrcColorBlendFactor(vk::BlendFactor::eOne)
      .setDstColorBlendFactor(vk::BlendFactor::eOneMinusSrcAlpha)
      .setSrcAlphaBlendFactor(vk::BlendFactor::eOne)
      .setDstAlphaBlendFactor(vk::BlendFactor::eOneMinusSrcAlpha);
  vk::PipelineColorBlendStateCreateInfo blending;
  blending.setAttachments(blend);
  const std::array dynamic_states{vk::DynamicState::eViewport, vk::DynamicState::eScissor};
  vk::PipelineDynamicStateCreateInfo dynamic;
  dynamic.setDynamicStates(dynamic_states);
  vk::PipelineRenderingCreateInfo rendering;
  rendering.setColorAttachmentFormats(colour_);
  if (recipe.depth != Recipe::Depth::kNone) rendering.setDepthAttachmentFormat(kDepthFormat);
  vk::GraphicsPipelineCreateInfo info;
  info.setStages(stages)
      .setPVertexInputState(&no_vertices)
      .setPInputAssemblyState(&assembly)
      .setPViewportState(&viewport)
      .setPRasterizationState(&raster)
      .setPMultisampleState(&one_sample)
      .setPDepthStencilState(&depth)
      .setPColorBlendState(&blending)
      .setPDynamicState(&dynamic)
      .setLayout(recipe.layout)
      .setPNext(&rendering);
  ++made_;
  return {context_.device(), nullptr, info};
}

namespace {

std::array<vk::Bool32, gpu::kSpecCount> constantsOf(const SurfaceVariant& v) {
  static_assert(gpu::kSpecPaged == 0 && gpu::kSpecMarks == 1 && gpu::kSpecDeviation == 2 &&
                gpu::kSpecContours == 3 && gpu::kSpecSmooth == 4 && gpu::kSpecHoles == 5 &&
                gpu::kSpecCell == 6 && gpu::kSpecByNeed == 7);
  return {v.paged, v.marks, v.deviation, v.contours, v.smooth, v.holes, v.cell_slopes, v.by_need};
}

}  // namespace

vk::Pipeline Pipelines::surface(const SurfaceVariant& variant) {
  const auto found = surfaces_.find(variant);
  if (found != surfaces_.end()) return *found->second;
  Recipe recipe{.vertex = surface_vert_spirv, .fragment = surface_frag_spirv, .layout = *scene_layout_};
  recipe.constants = constantsOf(variant);
  return *surfaces_.emplace(variant, make(recipe)).first->second;
}

vk::Pipeline Pipelines::seam(const SurfaceVariant& variant) {
  const auto found = seams_.find(variant);
  if (found != seams_.end()) return *found->second;
  Recipe recipe{.vertex = seam_vert_spirv, .fragment = surface_frag_spirv, .layout = *scene_layout_};
  recipe.constants = constantsOf(variant);
  return *seams_.emplace(variant, make(recipe)).first->second;
}

vk::Pipeline Pipelines::lines(Lines depth) {
  const auto found = lines_.find(depth);
  if (found != lines_.end()) return *found->second;
  const Recipe recipe{.vertex = line_vert_spirv,
                      .fragment = line_frag_spirv,
                      .layout = *scene_layout_,
                      .depth = depth == Lines::kInScene ? Recipe::Depth::kTest : Recipe::Depth::kIgnore,
                      .blend = Recipe::Blend::kPremultiplied};
  return *lines_.emplace(depth, make(recipe)).first->second;
}

vk::Pipeline Pipelines::wall(Paged paged) {
  const auto found = walls_.find(paged);
  if (found != walls_.end()) return *found->second;
  Recipe recipe{.vertex = wall_vert_spirv, .fragment = wall_frag_spirv, .layout = *scene_layout_};
  recipe.constants[gpu::kSpecPaged] = paged == Paged::kYes;
  recipe.constants[gpu::kSpecHoles] = VK_TRUE;
  recipe.constants[gpu::kSpecByNeed] = paged == Paged::kByNeed;
  return *walls_.emplace(paged, make(recipe)).first->second;
}

vk::Pipeline Pipelines::floor() {
  if (!*floor_)
    floor_ = make({.vertex = floor_vert_spirv, .fragment = floor_frag_spirv, .layout = *scene_layout_});
  return *floor_;
}

vk::Pipeline Pipelines::quads() {
  if (!*quads_)
    quads_ = make({.vertex = quad_vert_spirv,
                   .fragment = quad_frag_spirv,
                   .layout = *picture_layout_,
                   .depth = Recipe::Depth::kNone,
                   .blend = Recipe::Blend::kPremultiplied});
  return *quads_;
}

}  // namespace fettle::render
