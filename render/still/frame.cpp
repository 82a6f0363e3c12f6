#include "render/still/frame.h"

#include <chrono>
#include <cstring>

#include "render/vulkan/barrier.h"
#include "render/vulkan/pieces.h"

namespace fettle::render {
namespace {

using BufferUse = vk::BufferUsageFlagBits;

// Everything a panel's descriptors point at; lives until the frame is done.
struct PanelResources {
  Buffer uniforms, patches, walls;
  vk::raii::DescriptorSet surface_set = nullptr, wall_set = nullptr;
  vk::raii::DescriptorSet picture_set = nullptr;
};

vk::WriteDescriptorSet imageWrite(vk::DescriptorSet set, int binding, const vk::DescriptorImageInfo& info) {
  vk::WriteDescriptorSet write;
  return write.setDstSet(set)
      .setDstBinding(static_cast<std::uint32_t>(binding))
      .setDescriptorType(vk::DescriptorType::eSampledImage)
      .setImageInfo(info);
}

vk::WriteDescriptorSet bufferWrite(vk::DescriptorSet set, int binding, vk::DescriptorType type,
                                   const vk::DescriptorBufferInfo& info) {
  vk::WriteDescriptorSet write;
  return write.setDstSet(set)
      .setDstBinding(static_cast<std::uint32_t>(binding))
      .setDescriptorType(type)
      .setBufferInfo(info);
}

vk::DescriptorImageInfo reading(vk::ImageView view) {
  return {nullptr, view, vk::ImageLayout::eShaderReadOnlyOptimal};
}

vk::DescriptorBufferInfo all(const Buffer& buffer) {
  return {*buffer.handle(), 0, VK_WHOLE_SIZE};
}

}  // namespace

void Frame::bringGlyphs(const Glyphs& glyphs) {
  if (glyph_generation_ == glyphs.generation()) return;
  using Stage = vk::PipelineStageFlagBits2;
  using Access = vk::AccessFlagBits2;
  constexpr std::uint32_t kSide = Glyphs::kSide;
  if (glyph_generation_ == 0)
    glyphs_ = GpuImage(context_, vk::Format::eR8Unorm, {kSide, kSide}, 1, GpuImage::Kind::kPlane,
                       vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst,
                       vk::ImageAspectFlagBits::eColor);
  const Buffer staging = bufferOf<std::uint8_t>(context_, glyphs.image(), BufferUse::eTransferSrc);
  context_.run([&](const vk::raii::CommandBuffer& commands) {
    change(commands, glyphs_, vk::ImageLayout::eUndefined, vk::ImageLayout::eTransferDstOptimal,
           Stage::eFragmentShader, Access::eShaderRead, Stage::eCopy, Access::eTransferWrite);
    vk::BufferImageCopy copy;
    copy.setImageSubresource({vk::ImageAspectFlagBits::eColor, 0, 0, 1}).setImageExtent({kSide, kSide, 1});
    commands.copyBufferToImage(*staging.handle(), glyphs_.image(), vk::ImageLayout::eTransferDstOptimal,
                               copy);
    change(commands, glyphs_, vk::ImageLayout::eTransferDstOptimal, vk::ImageLayout::eShaderReadOnlyOptimal,
           Stage::eCopy, Access::eTransferWrite, Stage::eFragmentShader, Access::eShaderRead);
  });
  glyph_generation_ = glyphs.generation();
}

engine::Result<double> Frame::draw(const PicturePlan& plan, std::span<const PanelDraw> panels,
                                   const std::vector<gpu::Quad>& furniture, const FrameOptions& options,
                                   const Glyphs& glyphs, const PictureTarget& target,
                                   engine::JobControl& job) {
  bringGlyphs(glyphs);
  const auto start = std::chrono::steady_clock::now();
  const vk::raii::Device& device = context_.device();
  const auto panel_count = static_cast<std::uint32_t>(panels.size());
  const int samples = options.samples_per_side;

  const std::array sizes{vk::DescriptorPoolSize{vk::DescriptorType::eUniformBuffer, 3 * panel_count},
                         vk::DescriptorPoolSize{vk::DescriptorType::eSampledImage, 10 * panel_count},
                         vk::DescriptorPoolSize{vk::DescriptorType::eStorageBuffer, 3 * panel_count},
                         vk::DescriptorPoolSize{vk::DescriptorType::eSampler, 3 * panel_count},
                         vk::DescriptorPoolSize{vk::DescriptorType::eUniformTexelBuffer, 2 * panel_count}};
  vk::DescriptorPoolCreateInfo pool_info{vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                         3 * panel_count};
  const vk::raii::DescriptorPool pool(device, pool_info.setPoolSizes(sizes));
  const auto setOf = [&](vk::DescriptorSetLayout layout) {
    vk::DescriptorSetAllocateInfo info{*pool};
    return std::move(vk::raii::DescriptorSets(device, info.setSetLayouts(layout)).front());
  };

  // The panels come first, so that furniture may lie over them.
  std::vector<gpu::Quad> quads;
  scenes_.resize(panels.size());
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const Rectangle& plot = panels[i].panel->plot;
    const vk::Extent2D extent{static_cast<std::uint32_t>(plot.width * samples),
                              static_cast<std::uint32_t>(plot.height * samples)};
    if (scenes_[i].colour.extent() != extent) scenes_[i] = SceneTarget(context_, extent);
    gpu::Quad quad{};
    quad.pixels = {plot.x, plot.y, plot.x + plot.width, plot.y + plot.height};
    quad.uv = {0, 0, extent.width, extent.height};
    quad.colour = {0, 0, 0, 1};
    quad.fill = {gpu::kFillScene, samples, 0, 0};
    quads.push_back(quad);
  }
  quads.insert(quads.end(), furniture.begin(), furniture.end());
  const Buffer quad_buffer = bufferOf<gpu::Quad>(context_, quads, BufferUse::eStorageBuffer);

  const Buffer no_pages(context_, 256, BufferUse::eUniformTexelBuffer);
  const vk::raii::BufferView no_pages_view(device,
                                           {{}, *no_pages.handle(), vk::Format::eR32Uint, 0, VK_WHOLE_SIZE});
  std::vector<PanelResources> resources;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const PanelDraw& draw = panels[i];
    gpu::PanelUniforms uniforms = draw.panel->uniforms;
    const Paging& paging = draw.field->paging();
    uniforms.paging.x = paging.log2_columns;
    uniforms.paging.y = paging.log2_rows;
    uniforms.paging.z = static_cast<int>(paging.across);
    PanelResources r;
    r.uniforms = bufferOf<gpu::PanelUniforms>(context_, std::span(&uniforms, 1), BufferUse::eUniformBuffer);
    r.patches = bufferOf<gpu::Patch>(context_, draw.panel->detail.patches, BufferUse::eStorageBuffer);
    r.walls = bufferOf<gpu::Patch>(context_, draw.panel->detail.walls, BufferUse::eStorageBuffer);
    r.surface_set = setOf(pipelines_.sceneSet());
    r.wall_set = setOf(pipelines_.sceneSet());
    r.picture_set = setOf(pipelines_.pictureSet());
    const vk::DescriptorImageInfo heights = reading(draw.field->heights()),
                                  marks = reading(draw.field->marks());
    const vk::DescriptorImageInfo original =
        reading(draw.original != nullptr ? draw.original->heights() : draw.field->heights());
    const vk::DescriptorImageInfo scene = reading(scenes_[i].colour.view()),
                                  letters = reading(glyphs_.view());
    const vk::DescriptorBufferInfo block = all(r.uniforms), patches = all(r.patches), walls = all(r.walls);
    const vk::DescriptorBufferInfo quad_list = all(quad_buffer);
    std::vector<vk::WriteDescriptorSet> writes;
    for (const auto& [set, list] : {std::pair{*r.surface_set, &patches}, {*r.wall_set, &walls}}) {
      writes.push_back(bufferWrite(set, gpu::kBindPanel, vk::DescriptorType::eUniformBuffer, block));
      writes.push_back(imageWrite(set, gpu::kBindHeights, heights));
      writes.push_back(imageWrite(set, gpu::kBindShade, heights));
      writes.push_back(imageWrite(set, gpu::kBindMarks, marks));
      writes.push_back(imageWrite(set, gpu::kBindOriginal, original));
      writes.push_back(bufferWrite(set, gpu::kBindPatches, vk::DescriptorType::eStorageBuffer, *list));
      // Something to bind where the shader does not look.
      vk::WriteDescriptorSet pages{set, gpu::kBindPages, 0, 1, vk::DescriptorType::eUniformTexelBuffer};
      writes.push_back(pages.setPTexelBufferView(&*no_pages_view));
    }
    writes.push_back(imageWrite(*r.picture_set, gpu::kBindScene, scene));
    writes.push_back(imageWrite(*r.picture_set, gpu::kBindGlyphs, letters));
    writes.push_back(
        bufferWrite(*r.picture_set, gpu::kBindQuads, vk::DescriptorType::eStorageBuffer, quad_list));
    writes.push_back(bufferWrite(*r.picture_set, gpu::kBindMap, vk::DescriptorType::eUniformBuffer, block));
    device.updateDescriptorSets(writes, {});
    resources.push_back(std::move(r));
  }

  PieceRunner runner(context_, options.piece_ms, job);
  std::uint64_t steps = picturePieces(target.colour.extent(), samples).size();
  for (const PanelDraw& draw : panels)
    steps += kPieceSteps * (draw.panel->detail.patches.size() + 1 + draw.panel->detail.walls.size());
  job.begin("drawing", steps);

  constexpr auto kGraphics = vk::PipelineBindPoint::eGraphics;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const PanelDraw& draw = panels[i];
    const Detail& detail = draw.panel->detail;
    const bool paged = draw.field->paging().paged();
    const SceneTarget& scene = scenes_[i];
    Pass pass = Pass::kFirst;
    // Instances of one kind, in their order; pieces change nothing about what is drawn over what.
    const auto instances = [&](std::size_t count, vk::DescriptorSet set, vk::Pipeline pipeline,
                               std::uint32_t vertices) {
      return runner.instances(count, scene.colour.extent(),
                              [&](const vk::raii::CommandBuffer& commands, const Piece& piece) {
                                scene.begin(commands, pass);
                                pass = Pass::kNext;
                                commands.setScissor(0, piece.scissor);
                                commands.bindDescriptorSets(kGraphics, pipelines_.sceneLayout(), 0, set, {});
                                commands.bindPipeline(kGraphics, pipeline);
                                commands.draw(vertices, piece.count, 0, piece.first);
                                scene.end(commands);
                              });
    };
    if (!detail.patches.empty()) {
      const SurfaceVariant variant{paged, options.marks == MarksOverlay::kShow, draw.original != nullptr,
                                   options.contours == Contours::kShow, draw.panel->smooth};
      if (!instances(detail.patches.size(), *resources[i].surface_set, pipelines_.surface(variant),
                     gpu::kPatchVertices))
        return engine::cancelled();
    }
    // After the surface: nearly all of it lies behind, and the depth test spares its fragments.
    if (!instances(1, *resources[i].surface_set, pipelines_.floor(), 4)) return engine::cancelled();
    if (!detail.walls.empty() &&
        !instances(detail.walls.size(), *resources[i].wall_set,
                   pipelines_.wall(paged ? Pipelines::Paged::kYes : Pipelines::Paged::kNo),
                   gpu::kWallVertices))
      return engine::cancelled();
    context_.run([&](const vk::raii::CommandBuffer& commands) { scene.finish(commands); });
  }

  const vk::Extent2D extent = target.colour.extent();
  const glm::vec3& ground = plan.palette.ground;
  Pass pass = Pass::kFirst;
  for (const vk::Rect2D& band : picturePieces(extent, samples)) {
    const bool drawn = runner.one([&](const vk::raii::CommandBuffer& commands) {
      target.begin(commands, {ground.x, ground.y, ground.z}, pass);
      pass = Pass::kNext;
      commands.setScissor(0, band);
      commands.bindPipeline(kGraphics, pipelines_.quads());
      const gpu::vec4 size{extent.width, extent.height, 0, 0};
      commands.pushConstants<gpu::vec4>(pipelines_.pictureLayout(), vk::ShaderStageFlagBits::eVertex, 0,
                                        size);
      for (std::size_t i = 0; i < panels.size(); ++i) {
        commands.bindDescriptorSets(kGraphics, pipelines_.pictureLayout(), 0, *resources[i].picture_set, {});
        commands.draw(4, 1, 0, static_cast<std::uint32_t>(i));
      }
      if (!furniture.empty()) commands.draw(4, static_cast<std::uint32_t>(furniture.size()), 0, panel_count);
      target.end(commands);
    });
    if (!drawn) return engine::cancelled();
  }
  context_.run([&](const vk::raii::CommandBuffer& commands) { target.finish(commands); });
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace fettle::render
