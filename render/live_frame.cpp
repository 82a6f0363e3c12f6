#include "render/live_frame.h"

#include <algorithm>
#include <cstring>

namespace fettle::render {
namespace {

using ImageLayout = vk::ImageLayout;
using Stage = vk::PipelineStageFlagBits2;
using Access = vk::AccessFlagBits2;
constexpr auto kGraphics = vk::PipelineBindPoint::eGraphics;
// As large as any device asks offsets into buffers to be multiples of (Vulkan 1.3, limits).
constexpr vk::DeviceSize kAlign = 256;

vk::Rect2D rectOf(const Rectangle& r) {
  return {
      {r.x, r.y},
      {static_cast<std::uint32_t>(std::max(0, r.width)), static_cast<std::uint32_t>(std::max(0, r.height))}};
}

// What one frame's buffer is to hold, before it is known where.
class Packing {
 public:
  template <class T>
  std::pair<vk::DeviceSize, vk::DeviceSize> add(std::span<const T> items) {
    const vk::DeviceSize at = bytes_;
    parts_.push_back({at, items.data(), items.size_bytes()});
    // A buffer of no bytes cannot be bound.
    const vk::DeviceSize size = std::max<vk::DeviceSize>(items.size_bytes(), sizeof(T));
    bytes_ = (bytes_ + size + kAlign - 1) / kAlign * kAlign;
    return {at, size};
  }
  [[nodiscard]] vk::DeviceSize bytes() const noexcept { return bytes_; }
  void write(std::byte* out) const {
    for (const Part& p : parts_)
      if (p.bytes > 0) std::memcpy(out + p.at, p.data, p.bytes);
  }

 private:
  struct Part {
    vk::DeviceSize at;
    const void* data;
    std::size_t bytes;
  };
  std::vector<Part> parts_;
  vk::DeviceSize bytes_ = 0;
};

// Descriptor writes point at infos that must stay put until they are applied.
class Writes {
 public:
  void image(vk::DescriptorSet set, int binding, vk::ImageView view) {
    images_.push_back({nullptr, view, ImageLayout::eShaderReadOnlyOptimal});
    add(set, binding, vk::DescriptorType::eSampledImage, &images_.back(), nullptr);
  }
  void buffer(vk::DescriptorSet set, int binding, vk::DescriptorType type, const Buffer& buffer,
              std::pair<vk::DeviceSize, vk::DeviceSize> block) {
    buffers_.push_back({*buffer.handle(), block.first, block.second});
    add(set, binding, type, nullptr, &buffers_.back());
  }
  void texels(vk::DescriptorSet set, int binding, vk::BufferView view) {
    views_.push_back(view);
    add(set, binding, vk::DescriptorType::eUniformTexelBuffer, nullptr, nullptr, &views_.back());
  }
  void apply(const vk::raii::Device& device) const { device.updateDescriptorSets(writes_, {}); }

 private:
  void add(vk::DescriptorSet set, int binding, vk::DescriptorType type, const vk::DescriptorImageInfo* image,
           const vk::DescriptorBufferInfo* buffer, const vk::BufferView* view = nullptr) {
    writes_.push_back({set, static_cast<std::uint32_t>(binding), 0, 1, type, image, buffer, view});
  }
  std::deque<vk::DescriptorImageInfo> images_;
  std::deque<vk::DescriptorBufferInfo> buffers_;
  std::deque<vk::BufferView> views_;
  std::vector<vk::WriteDescriptorSet> writes_;
};

}  // namespace

LiveFrame::LiveFrame(Context& context, vk::Format colour) : context_(context), pipelines_(context, colour) {
  constexpr auto kSlots = static_cast<std::uint32_t>(Submissions::kInFlight);
  constexpr std::uint32_t kSets = kSlots * (5 * kMostPanels + 1);
  const std::array sizes{vk::DescriptorPoolSize{vk::DescriptorType::eUniformBuffer, kSets},
                         vk::DescriptorPoolSize{vk::DescriptorType::eSampledImage, 4 * kSets},
                         vk::DescriptorPoolSize{vk::DescriptorType::eStorageBuffer, 2 * kSets},
                         vk::DescriptorPoolSize{vk::DescriptorType::eUniformTexelBuffer, kSets}};
  vk::DescriptorPoolCreateInfo info{vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, kSets};
  pool_ = vk::raii::DescriptorPool(context.device(), info.setPoolSizes(sizes));
  const auto setOf = [&](vk::DescriptorSetLayout layout) {
    vk::DescriptorSetAllocateInfo wanted{*pool_};
    return std::move(vk::raii::DescriptorSets(context.device(), wanted.setSetLayouts(layout)).front());
  };
  no_pages_ = Buffer(context, kAlign, vk::BufferUsageFlagBits::eUniformTexelBuffer);
  no_pages_view_ = vk::raii::BufferView(context.device(),
                                        {{}, *no_pages_.handle(), vk::Format::eR32Uint, 0, VK_WHOLE_SIZE});
  for (Slot& slot : slots_) {
    for (PanelSets& p : slot.panels)
      for (vk::raii::DescriptorSet* set : {&p.surface, &p.seams, &p.walls, &p.in_scene, &p.on_top})
        *set = setOf(pipelines_.sceneSet());
    slot.picture = setOf(pipelines_.pictureSet());
  }
}

void LiveFrame::bringGlyphs(const vk::raii::CommandBuffer& commands, StagingRing& staging,
                            std::uint64_t submission, const Glyphs& glyphs) {
  if (glyph_generation_ == glyphs.generation()) return;
  constexpr std::uint32_t kSide = Glyphs::kSide;
  const bool first = glyph_generation_ == 0;
  if (first)
    glyphs_ = GpuImage(context_, vk::Format::eR8Unorm, {kSide, kSide}, 1, GpuImage::Kind::kPlane,
                       vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst,
                       vk::ImageAspectFlagBits::eColor);
  const std::optional<vk::DeviceSize> at = staging.take(glyphs.image().size(), submission);
  // No room: the letters come with a later frame.
  if (!at && !first) return;
  if (at) std::memcpy(staging.buffer().data() + *at, glyphs.image().data(), glyphs.image().size());
  change(commands, glyphs_, first ? ImageLayout::eUndefined : ImageLayout::eShaderReadOnlyOptimal,
         ImageLayout::eTransferDstOptimal, Stage::eFragmentShader, Access::eShaderRead, Stage::eCopy,
         Access::eTransferWrite);
  if (at) {
    vk::BufferImageCopy copy;
    copy.setBufferOffset(*at)
        .setImageSubresource({vk::ImageAspectFlagBits::eColor, 0, 0, 1})
        .setImageExtent({kSide, kSide, 1});
    commands.copyBufferToImage(*staging.buffer().handle(), glyphs_.image(), ImageLayout::eTransferDstOptimal,
                               copy);
    glyph_generation_ = glyphs.generation();
  }
  change(commands, glyphs_, ImageLayout::eTransferDstOptimal, ImageLayout::eShaderReadOnlyOptimal,
         Stage::eCopy, Access::eTransferWrite, Stage::eFragmentShader, Access::eShaderRead);
}

void LiveFrame::record(Submissions& submissions, StagingRing& staging, std::span<const LivePanel> panels,
                       const std::vector<gpu::Quad>& furniture, const glm::vec3& ground, const Glyphs& glyphs,
                       const LiveTarget& target) {
  const vk::raii::CommandBuffer& commands = submissions.commands();
  Slot& slot = slots_[submissions.next() % Submissions::kInFlight];
  if (!furniture.empty()) bringGlyphs(commands, staging, submissions.next(), glyphs);
  if (depth_.extent() != target.extent)
    // The frame in flight draws with the old one.
    submissions.finish(),
        depth_ = GpuImage(context_, kDepthFormat, target.extent, 1, GpuImage::Kind::kPlane,
                          vk::ImageUsageFlagBits::eDepthStencilAttachment, vk::ImageAspectFlagBits::eDepth);

  Packing packing;
  struct Blocks {
    std::pair<vk::DeviceSize, vk::DeviceSize> uniforms, patches, seams, walls, in_scene, on_top, pages;
  };
  std::vector<Blocks> blocks;
  for (const LivePanel& p : panels)
    blocks.push_back({packing.add<gpu::PanelUniforms>(std::span(&p.uniforms, 1)),
                      packing.add<gpu::Patch>(p.choice->patches), packing.add<gpu::Patch>(p.choice->seams),
                      packing.add<gpu::Patch>(p.choice->walls), packing.add<gpu::Line>(p.in_scene),
                      packing.add<gpu::Line>(p.on_top), packing.add<std::uint32_t>(p.pages)});
  const auto quads = packing.add<gpu::Quad>(furniture);
  if (slot.arena.bytes() < packing.bytes())
    slot.arena = Buffer(context_, std::max<vk::DeviceSize>(2 * packing.bytes(), 1 << 16),
                        vk::BufferUsageFlagBits::eUniformBuffer | vk::BufferUsageFlagBits::eStorageBuffer |
                            vk::BufferUsageFlagBits::eUniformTexelBuffer);
  packing.write(slot.arena.data());

  Writes writes;
  constexpr auto kUniform = vk::DescriptorType::eUniformBuffer, kStorage = vk::DescriptorType::eStorageBuffer;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const LivePanel& p = panels[i];
    PanelSets& sets = slot.panels[i];
    if (p.variant.by_need)
      sets.pages = vk::raii::BufferView(
          context_.device(),
          {{}, *slot.arena.handle(), vk::Format::eR32Uint, blocks[i].pages.first, blocks[i].pages.second});
    for (const auto& [set, list] : {std::pair{*sets.surface, blocks[i].patches},
                                    {*sets.seams, blocks[i].seams},
                                    {*sets.walls, blocks[i].walls}}) {
      writes.buffer(set, gpu::kBindPanel, kUniform, slot.arena, blocks[i].uniforms);
      writes.image(set, gpu::kBindHeights, p.field->heights(0));
      writes.image(set, gpu::kBindShade, p.field->heights(p.shade_level));
      writes.image(set, gpu::kBindMarks, p.field->marks(p.shade_level));
      writes.image(set, gpu::kBindOriginal,
                   (p.original != nullptr ? p.original : p.field)->heights(p.shade_level));
      writes.buffer(set, gpu::kBindPatches, kStorage, slot.arena, list);
      writes.texels(set, gpu::kBindPages, p.variant.by_need ? *sets.pages : *no_pages_view_);
    }
    for (const auto& [set, list] :
         {std::pair{*sets.in_scene, blocks[i].in_scene}, {*sets.on_top, blocks[i].on_top}}) {
      writes.buffer(set, gpu::kBindPanel, kUniform, slot.arena, blocks[i].uniforms);
      writes.buffer(set, gpu::kBindLines, kStorage, slot.arena, list);
    }
  }
  if (!furniture.empty()) {
    writes.image(*slot.picture, gpu::kBindScene, glyphs_.view());  // live frames draw straight to the picture
    writes.image(*slot.picture, gpu::kBindGlyphs, glyphs_.view());
    writes.buffer(*slot.picture, gpu::kBindQuads, kStorage, slot.arena, quads);
    writes.buffer(*slot.picture, gpu::kBindMap, kUniform, slot.arena, blocks.front().uniforms);
  }
  writes.apply(context_.device());

  // The acquired image is waited for at this stage: the change of layout comes after it.
  change(commands, target.image, ImageLayout::eUndefined, ImageLayout::eColorAttachmentOptimal,
         Stage::eColorAttachmentOutput | Stage::eCopy, {}, Stage::eColorAttachmentOutput,
         Access::eColorAttachmentRead | Access::eColorAttachmentWrite);
  change(commands, depth_, ImageLayout::eUndefined, ImageLayout::eDepthAttachmentOptimal,
         Stage::eEarlyFragmentTests | Stage::eLateFragmentTests, Access::eDepthStencilAttachmentWrite,
         Stage::eEarlyFragmentTests | Stage::eLateFragmentTests,
         Access::eDepthStencilAttachmentRead | Access::eDepthStencilAttachmentWrite);
  vk::RenderingAttachmentInfo colour, depth;
  colour.setImageView(target.view)
      .setImageLayout(ImageLayout::eColorAttachmentOptimal)
      .setLoadOp(vk::AttachmentLoadOp::eClear)
      .setStoreOp(vk::AttachmentStoreOp::eStore)
      .setClearValue(vk::ClearColorValue(std::array<float, 4>{ground.x, ground.y, ground.z, 1.0F}));
  depth.setImageView(depth_.view())
      .setImageLayout(ImageLayout::eDepthAttachmentOptimal)
      .setLoadOp(vk::AttachmentLoadOp::eClear)
      .setStoreOp(vk::AttachmentStoreOp::eDontCare)
      .setClearValue(vk::ClearDepthStencilValue{1.0F, 0});
  vk::RenderingInfo rendering;
  rendering.setRenderArea({{0, 0}, target.extent})
      .setLayerCount(1)
      .setColorAttachments(colour)
      .setPDepthAttachment(&depth);
  commands.beginRendering(rendering);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const LivePanel& p = panels[i];
    const PanelSets& sets = slot.panels[i];
    const vk::Rect2D plot = rectOf(p.plot), visible = rectOf(p.visible);
    if (visible.extent.width == 0 || visible.extent.height == 0) continue;
    commands.setViewport(0, vk::Viewport{static_cast<float>(plot.offset.x), static_cast<float>(plot.offset.y),
                                         static_cast<float>(plot.extent.width),
                                         static_cast<float>(plot.extent.height), 0.0F, 1.0F});
    commands.setScissor(0, visible);
    const gpu::vec4 size{plot.extent.width, plot.extent.height, 0, 0};
    commands.pushConstants<gpu::vec4>(pipelines_.sceneLayout(), vk::ShaderStageFlagBits::eVertex, 0, size);
    const auto draw = [&](std::size_t count, vk::Pipeline pipeline, vk::DescriptorSet set,
                          std::uint32_t vertices) {
      if (count == 0) return;
      commands.bindPipeline(kGraphics, pipeline);
      commands.bindDescriptorSets(kGraphics, pipelines_.sceneLayout(), 0, set, {});
      commands.draw(vertices, static_cast<std::uint32_t>(count), 0, 0);
    };
    const auto paged = p.variant.by_need ? Pipelines::Paged::kByNeed
                       : p.variant.paged ? Pipelines::Paged::kYes
                                         : Pipelines::Paged::kNo;
    draw(p.choice->patches.size(), pipelines_.surface(p.variant), *sets.surface, gpu::kPatchVertices);
    if (!p.choice->seams.empty())
      draw(2 * p.choice->seams.size(), pipelines_.seam(p.variant), *sets.seams, gpu::kSeamStripVertices);
    // The plate is seen through holes alone.
    if (p.variant.holes) draw(1, pipelines_.floor(), *sets.surface, 4);
    draw(p.choice->walls.size(), pipelines_.wall(paged), *sets.walls, gpu::kWallVertices);
    if (!p.in_scene.empty())
      draw(p.in_scene.size(), pipelines_.lines(Pipelines::Lines::kInScene), *sets.in_scene, 4);
    if (!p.on_top.empty()) draw(p.on_top.size(), pipelines_.lines(Pipelines::Lines::kOnTop), *sets.on_top, 4);
  }
  commands.endRendering();

  if (!furniture.empty() || target.over) {
    change(commands, target.image, ImageLayout::eColorAttachmentOptimal, ImageLayout::eColorAttachmentOptimal,
           Stage::eColorAttachmentOutput, Access::eColorAttachmentWrite, Stage::eColorAttachmentOutput,
           Access::eColorAttachmentRead | Access::eColorAttachmentWrite);
    colour.setLoadOp(vk::AttachmentLoadOp::eLoad);
    rendering.setPDepthAttachment(nullptr);
    commands.beginRendering(rendering);
    if (!furniture.empty()) {
      commands.setViewport(0, vk::Viewport{0.0F, 0.0F, static_cast<float>(target.extent.width),
                                           static_cast<float>(target.extent.height), 0.0F, 1.0F});
      commands.setScissor(0, vk::Rect2D{{0, 0}, target.extent});
      commands.bindPipeline(kGraphics, pipelines_.quads());
      const gpu::vec4 size{target.extent.width, target.extent.height, 0, 0};
      commands.pushConstants<gpu::vec4>(pipelines_.pictureLayout(), vk::ShaderStageFlagBits::eVertex, 0,
                                        size);
      commands.bindDescriptorSets(kGraphics, pipelines_.pictureLayout(), 0, *slot.picture, {});
      commands.draw(4, static_cast<std::uint32_t>(furniture.size()), 0, 0);
    }
    if (target.over) target.over(*commands);
    commands.endRendering();
  }
  const bool copied = target.leaves_as == ImageLayout::eTransferSrcOptimal;
  change(commands, target.image, ImageLayout::eColorAttachmentOptimal, target.leaves_as,
         Stage::eColorAttachmentOutput, Access::eColorAttachmentWrite,
         copied ? Stage::eCopy : Stage::eBottomOfPipe,
         copied ? vk::AccessFlags2(Access::eTransferRead) : vk::AccessFlags2{});
}

}  // namespace fettle::render
