#include "render/vulkan/pipelines.h"

#include <array>
#include <utility>

#include "render/vulkan/picture_pipeline.h"

#include "floor.frag.h"
#include "floor.vert.eyes.h"
#include "floor.vert.h"
#include "holes.frag.h"
#include "line.frag.h"
#include "line.vert.eyes.h"
#include "line.vert.h"
#include "quad.frag.h"
#include "quad.vert.h"
#include "seam.vert.eyes.h"
#include "seam.vert.h"
#include "shade.frag.eyes.h"
#include "shade.frag.h"
#include "shade.vert.eyes.h"
#include "shade.vert.h"
#include "shaders/layout.h"
#include "stylus.frag.h"
#include "stylus.vert.eyes.h"
#include "stylus.vert.h"
#include "stylus_shadow.frag.eyes.h"
#include "stylus_shadow.frag.h"
#include "stylus_shadow.vert.eyes.h"
#include "stylus_shadow.vert.h"
#include "surface.vert.eyes.h"
#include "surface.vert.h"
#include "wall.frag.h"
#include "wall.vert.eyes.h"
#include "wall.vert.h"

namespace fettle::render {
namespace {

using ShaderStage = vk::ShaderStageFlagBits;

vk::DescriptorSetLayoutBinding binding(int number, vk::DescriptorType type) {
  return {static_cast<std::uint32_t>(number), type, 1, ShaderStage::eVertex | ShaderStage::eFragment};
}

}  // namespace

// What differs between the pipelines.
struct Pipelines::Recipe {
  Words vertex;
  Words fragment = {};  // none: depth alone
  vk::PipelineLayout layout;
  vk::PrimitiveTopology topology = vk::PrimitiveTopology::eTriangleStrip;
  enum class Depth { kTestAndWrite, kTest, kBehind, kIgnore, kNone } depth = Depth::kTestAndWrite;
  using Blend = PicturePass::Blend;
  Blend blend = Blend::kReplace;
  enum class Colour { kYes, kNone } colour = Colour::kYes;
  std::array<vk::Bool32, gpu::kSpecCount> constants{};  // by constant_id
};

Pipelines::Pipelines(const Context& context, vk::Format colour, Views views)
    : context_(context), colour_(colour), views_(views) {
  nearest_ = vk::raii::Sampler(context.device(), vk::SamplerCreateInfo{}
                                                     .setAddressModeU(vk::SamplerAddressMode::eClampToEdge)
                                                     .setAddressModeV(vk::SamplerAddressMode::eClampToEdge));
  const std::array scene{
      binding(gpu::kBindPanel, vk::DescriptorType::eUniformBuffer),
      binding(gpu::kBindHeights, vk::DescriptorType::eSampledImage),
      binding(gpu::kBindMarks, vk::DescriptorType::eSampledImage),
      binding(gpu::kBindOriginal, vk::DescriptorType::eSampledImage),
      binding(gpu::kBindPatches, vk::DescriptorType::eStorageBuffer),
      binding(gpu::kBindShade, vk::DescriptorType::eSampledImage),
      binding(gpu::kBindLines, vk::DescriptorType::eStorageBuffer),
      binding(gpu::kBindPages, vk::DescriptorType::eUniformTexelBuffer),
      binding(gpu::kBindDepth, vk::DescriptorType::eSampledImage),
      binding(gpu::kBindStylus, vk::DescriptorType::eStorageBuffer),
      binding(gpu::kBindNearest, vk::DescriptorType::eSampler).setImmutableSamplers(*nearest_)};
  const std::array picture{binding(gpu::kBindGlyphs, vk::DescriptorType::eSampledImage),
                           binding(gpu::kBindQuads, vk::DescriptorType::eStorageBuffer),
                           binding(gpu::kBindMap, vk::DescriptorType::eUniformBuffer)};
  vk::DescriptorSetLayoutCreateInfo set;
  scene_set_ = vk::raii::DescriptorSetLayout(context.device(), set.setBindings(scene));
  picture_set_ = vk::raii::DescriptorSetLayout(context.device(), set.setBindings(picture));
  vk::PipelineLayoutCreateInfo layout;
  const vk::PushConstantRange push{ShaderStage::eVertex, 0, sizeof(gpu::vec4)};
  scene_layout_ = vk::raii::PipelineLayout(context.device(),
                                           layout.setSetLayouts(*scene_set_).setPushConstantRanges(push));
  picture_layout_ = vk::raii::PipelineLayout(context.device(),
                                             layout.setSetLayouts(*picture_set_).setPushConstantRanges(push));
}

Pipelines::Words Pipelines::one(Words for_one, Words for_both) const noexcept {
  return views_ == Views::kBoth ? for_both : for_one;
}

vk::raii::Pipeline Pipelines::make(const Recipe& recipe) const {
  std::array<vk::SpecializationMapEntry, gpu::kSpecCount> entries;
  for (std::uint32_t i = 0; i < entries.size(); ++i)
    entries[i] =
        vk::SpecializationMapEntry{i, i * static_cast<std::uint32_t>(sizeof(vk::Bool32)), sizeof(vk::Bool32)};
  vk::SpecializationInfo constants;
  constants.setMapEntries(entries).setDataSize(sizeof(recipe.constants)).setPData(recipe.constants.data());
  PicturePass pass{.vertex = recipe.vertex,
                   .fragment = recipe.fragment,
                   .topology = recipe.topology,
                   .layout = recipe.layout,
                   .constants = &constants,
                   .blend = recipe.blend,
                   .view_mask = views_ == Views::kBoth ? std::uint32_t{gpu::kBothViews} : 0U};
  if (recipe.colour == Recipe::Colour::kYes) pass.colour = colour_;
  if (recipe.depth != Recipe::Depth::kNone) pass.depth_format = kDepthFormat;
  const bool writes = recipe.depth == Recipe::Depth::kTestAndWrite;
  const bool behind = recipe.depth == Recipe::Depth::kBehind;
  pass.depth.setDepthTestEnable(writes || behind || recipe.depth == Recipe::Depth::kTest)
      .setDepthWriteEnable(writes)
      .setDepthCompareOp(behind ? vk::CompareOp::eGreater : vk::CompareOp::eLessOrEqual);
  return makePipeline(context_, pass);
}

namespace {

std::array<vk::Bool32, gpu::kSpecCount> constantsOf(const SurfaceVariant& v) {
  static_assert(gpu::kSpecPaged == 0 && gpu::kSpecMarks == 1 && gpu::kSpecDeviation == 2 &&
                gpu::kSpecContours == 3 && gpu::kSpecSmooth == 4 && gpu::kSpecHoles == 5 &&
                gpu::kSpecCell == 6 && gpu::kSpecOnDemand == 7 && gpu::kSpecGather == 8 &&
                gpu::kSpecPerspective == 9 && gpu::kSpecFootprint == 10 && gpu::kSpecOcclusion == 11 &&
                gpu::kSpecCavity == 12 && gpu::kSpecFaint == 13 && gpu::kSpecMaterial == 14);
  return {v.paged,  v.marks,       v.deviation, v.contours,  v.smooth, v.holes, v.cell_slopes, v.on_demand,
          v.gather, v.perspective, v.footprint, v.occlusion, v.cavity, false,   v.material};
}

}  // namespace

Pipelines::Recipe Pipelines::recipeOf(const Geometry& geometry) const {
  Recipe recipe{.vertex = geometry.kind == Geometry::Kind::kSeams
                              ? one(seam_vert_spirv, seam_vert_eyes_spirv)
                              : one(surface_vert_spirv, surface_vert_eyes_spirv),
                .layout = *scene_layout_,
                .colour = Recipe::Colour::kNone};
  if (geometry.holes == Holes::kYes) recipe.fragment = holes_frag_spirv;
  recipe.constants[gpu::kSpecPaged] = geometry.paged == Paged::kYes;
  recipe.constants[gpu::kSpecOnDemand] = geometry.paged == Paged::kByNeed;
  recipe.constants[gpu::kSpecHoles] = geometry.holes == Holes::kYes;
  return recipe;
}

Pipelines::Recipe Pipelines::recipeOf(const SurfaceVariant& variant) const {
  Recipe recipe{.vertex = one(shade_vert_spirv, shade_vert_eyes_spirv),
                .fragment = one(shade_frag_spirv, shade_frag_eyes_spirv),
                .layout = *scene_layout_,
                .depth = Recipe::Depth::kBehind};
  recipe.constants = constantsOf(variant);
  return recipe;
}

Pipelines::Recipe Pipelines::recipeOf(Lines depth) const {
  return {.vertex = one(line_vert_spirv, line_vert_eyes_spirv),
          .fragment = line_frag_spirv,
          .layout = *scene_layout_,
          .depth = depth == Lines::kInScene ? Recipe::Depth::kTest : Recipe::Depth::kIgnore,
          .blend = Recipe::Blend::kPremultiplied};
}

Pipelines::Recipe Pipelines::recipeOf(Stylus pass) const {
  const bool shadow = pass == Stylus::kShadow;
  Recipe recipe{
      .vertex = shadow ? one(stylus_shadow_vert_spirv, stylus_shadow_vert_eyes_spirv)
                       : one(stylus_vert_spirv, stylus_vert_eyes_spirv),
      .fragment =
          shadow ? one(stylus_shadow_frag_spirv, stylus_shadow_frag_eyes_spirv) : Words(stylus_frag_spirv),
      .layout = *scene_layout_,
      .topology = shadow ? vk::PrimitiveTopology::eTriangleStrip : vk::PrimitiveTopology::eTriangleList,
      .depth = pass == Stylus::kSeen ? Recipe::Depth::kTest : Recipe::Depth::kIgnore,
      .blend = Recipe::Blend::kPremultiplied};
  recipe.constants[gpu::kSpecFaint] = pass == Stylus::kHidden;
  return recipe;
}

Pipelines::Recipe Pipelines::recipeOf(const Wall& wall) const {
  Recipe recipe{.vertex = one(wall_vert_spirv, wall_vert_eyes_spirv),
                .fragment = wall_frag_spirv,
                .layout = *scene_layout_};
  recipe.constants[gpu::kSpecPaged] = wall.paged == Paged::kYes;
  recipe.constants[gpu::kSpecHoles] = wall.holes == Holes::kYes;
  recipe.constants[gpu::kSpecOnDemand] = wall.paged == Paged::kByNeed;
  return recipe;
}

Pipelines::Recipe Pipelines::recipeOf(Flat what) const {
  if (what == Flat::kFloor)
    return {.vertex = one(floor_vert_spirv, floor_vert_eyes_spirv),
            .fragment = floor_frag_spirv,
            .layout = *scene_layout_};
  return {.vertex = quad_vert_spirv,
          .fragment = quad_frag_spirv,
          .layout = *picture_layout_,
          .depth = Recipe::Depth::kNone,
          .blend = Recipe::Blend::kPremultiplied};
}

vk::Pipeline Pipelines::found(const Kind& kind) const {
  const std::scoped_lock lock(mutex_);
  const auto at = made_.find(kind);
  return at == made_.end() ? vk::Pipeline() : *at->second;
}

vk::Pipeline Pipelines::of(const Kind& kind) {
  if (const vk::Pipeline there = found(kind)) return there;
  vk::raii::Pipeline pipeline = std::visit([this](const auto& each) { return make(recipeOf(each)); }, kind);
  const std::scoped_lock lock(mutex_);
  // Another thread may have been quicker: its pipeline may be in use.
  return *made_.try_emplace(kind, std::move(pipeline)).first->second;
}

std::vector<Pipelines::Kind> Pipelines::kinds() const {
  const std::scoped_lock lock(mutex_);
  std::vector<Kind> kinds;
  kinds.reserve(made_.size());
  for (const auto& [kind, pipeline] : made_) kinds.push_back(kind);
  return kinds;
}

bool Pipelines::prepare(const Kind& kind) {
  if (found(kind)) return false;
  (void)of(kind);
  return true;
}

}  // namespace fettle::render
