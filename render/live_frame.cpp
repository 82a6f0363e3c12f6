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
  void image(vk::DescriptorSet set, int binding, vk::ImageView view,
             ImageLayout layout = ImageLayout::eShaderReadOnlyOptimal) {
    images_.push_back({nullptr, view, layout});
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

vk::AttachmentLoadOp loadOf(LiveFrame::Redraw redraw) {
  return redraw == LiveFrame::Redraw::kAll ? vk::AttachmentLoadOp::eClear : vk::AttachmentLoadOp::eLoad;
}

// Several images change at once: a device may stop for each barrier.
class Changes {
 public:
  void add(vk::Image image, vk::ImageAspectFlags aspect, ImageLayout from, ImageLayout to,
           vk::PipelineStageFlags2 before, vk::AccessFlags2 before_access, vk::PipelineStageFlags2 after,
           vk::AccessFlags2 after_access) {
    vk::ImageMemoryBarrier2 step;
    step.setSrcStageMask(before)
        .setSrcAccessMask(before_access)
        .setDstStageMask(after)
        .setDstAccessMask(after_access)
        .setOldLayout(from)
        .setNewLayout(to)
        .setSrcQueueFamilyIndex(VK_QUEUE_FAMILY_IGNORED)
        .setDstQueueFamilyIndex(VK_QUEUE_FAMILY_IGNORED)
        .setImage(image)
        .setSubresourceRange({aspect, 0, 1, 0, VK_REMAINING_ARRAY_LAYERS});
    steps_.push_back(step);
  }
  void record(const vk::raii::CommandBuffer& commands) const {
    vk::DependencyInfo dependency;
    dependency.setImageMemoryBarriers(steps_);
    commands.pipelineBarrier2(dependency);
  }

 private:
  std::vector<vk::ImageMemoryBarrier2> steps_;
};

constexpr auto kColour = vk::ImageAspectFlagBits::eColor;
constexpr auto kDepth = vk::ImageAspectFlagBits::eDepth;
constexpr auto kDepthStages = Stage::eEarlyFragmentTests | Stage::eLateFragmentTests;
constexpr auto kDepthAccess = Access::eDepthStencilAttachmentRead | Access::eDepthStencilAttachmentWrite;
constexpr auto kColourAccess = Access::eColorAttachmentRead | Access::eColorAttachmentWrite;

vk::RenderingAttachmentInfo attachment(vk::ImageView view, ImageLayout layout, vk::AttachmentLoadOp load,
                                       vk::ClearValue clear = {}) {
  vk::RenderingAttachmentInfo info;
  info.setImageView(view)
      .setImageLayout(layout)
      .setLoadOp(load)
      .setStoreOp(vk::AttachmentStoreOp::eStore)
      .setClearValue(clear);
  return info;
}

Pipelines::Paged pagedOf(const LivePanel& p) {
  return p.variant.by_need ? Pipelines::Paged::kByNeed
         : p.variant.paged ? Pipelines::Paged::kYes
                           : Pipelines::Paged::kNo;
}
Pipelines::Holes holesOf(const LivePanel& p) {
  return p.variant.holes ? Pipelines::Holes::kYes : Pipelines::Holes::kNo;
}

bool empty(const Rectangle& r) {
  return r.width <= 0 || r.height <= 0;
}

const Rectangle& partOf(const LivePanel& p, LiveFrame::Redraw redraw) {
  return redraw == LiveFrame::Redraw::kAll ? p.visible : p.redraw;
}

// Sets a part of the attachment of the rendering under way back to where nothing is drawn.
void clear(const vk::raii::CommandBuffer& commands, vk::ImageAspectFlags aspect, const vk::ClearValue& value,
           const Rectangle& part) {
  commands.clearAttachments(vk::ClearAttachment{aspect, 0, value}, vk::ClearRect{rectOf(part), 0, 1});
}

}  // namespace

LiveFrame::LiveFrame(Context& context, vk::Format colour, Pipelines::Views views)
    : context_(context),
      colour_(colour),
      layers_(views == Pipelines::Views::kBoth ? 2 : 1),
      view_mask_(views == Pipelines::Views::kBoth ? gpu::kBothViews : 0),
      pipelines_(context, colour, views) {
  constexpr auto kSlots = static_cast<std::uint32_t>(Submissions::kInFlight);
  constexpr std::uint32_t kSets = kSlots * (5 * kMostPanels + 1);
  const std::array sizes{vk::DescriptorPoolSize{vk::DescriptorType::eUniformBuffer, kSets},
                         vk::DescriptorPoolSize{vk::DescriptorType::eSampledImage, 5 * kSets},
                         vk::DescriptorPoolSize{vk::DescriptorType::eStorageBuffer, 2 * kSets},
                         vk::DescriptorPoolSize{vk::DescriptorType::eSampler, kSets},
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

void LiveFrame::makeLayers(Submissions& submissions, vk::Extent2D extent) {
  if (depth_.extent() == extent) return;
  // The frame in flight draws with the old ones.
  submissions.finish();
  using Usage = vk::ImageUsageFlagBits;
  const GpuImage::Kind kind = layers_ == 1 ? GpuImage::Kind::kPlane : GpuImage::Kind::kArray;
  depth_ = GpuImage(context_, kDepthFormat, extent, layers_, kind,
                    Usage::eDepthStencilAttachment | Usage::eSampled, kDepth);
  base_ = GpuImage(context_, colour_, extent, layers_, kind, Usage::eColorAttachment | Usage::eTransferSrc,
                   kColour);
}

void LiveFrame::fill(Slot& slot, std::span<const LivePanel> panels, const std::vector<gpu::Quad>& furniture) {
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
    writes.image(*sets.surface, gpu::kBindDepth, depth_.view(), ImageLayout::eDepthReadOnlyOptimal);
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
}

void LiveFrame::beginPanel(const vk::raii::CommandBuffer& commands, const LivePanel& panel,
                           const Rectangle& part) {
  const vk::Rect2D plot = rectOf(panel.plot);
  commands.setViewport(0, vk::Viewport{static_cast<float>(plot.offset.x), static_cast<float>(plot.offset.y),
                                       static_cast<float>(plot.extent.width),
                                       static_cast<float>(plot.extent.height), 0.0F, 1.0F});
  commands.setScissor(0, rectOf(part));
  const gpu::vec4 size{plot.extent.width, plot.extent.height, plot.offset.x, plot.offset.y};
  commands.pushConstants<gpu::vec4>(pipelines_.sceneLayout(), vk::ShaderStageFlagBits::eVertex, 0, size);
}

void LiveFrame::instances(const vk::raii::CommandBuffer& commands, vk::Pipeline pipeline,
                          vk::DescriptorSet set, std::uint32_t vertices, std::size_t first,
                          std::size_t count) const {
  commands.bindPipeline(kGraphics, pipeline);
  commands.bindDescriptorSets(kGraphics, pipelines_.sceneLayout(), 0, set, {});
  commands.draw(vertices, static_cast<std::uint32_t>(count), 0, static_cast<std::uint32_t>(first));
}

void LiveFrame::recordDepth(const vk::raii::CommandBuffer& commands, const Slot& slot,
                            std::span<const LivePanel> panels, Redraw redraw) {
  using Geometry = Pipelines::Geometry;
  const vk::RenderingAttachmentInfo depth = attachment(depth_.view(), ImageLayout::eDepthAttachmentOptimal,
                                                       loadOf(redraw), vk::ClearDepthStencilValue{1.0F, 0});
  vk::RenderingInfo rendering;
  rendering.setRenderArea({{0, 0}, depth_.extent()})
      .setLayerCount(1)
      .setViewMask(view_mask_)
      .setPDepthAttachment(&depth);
  commands.beginRendering(rendering);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const LivePanel& p = panels[i];
    const Rectangle& part = partOf(p, redraw);
    if (empty(part)) continue;
    beginPanel(commands, p, part);
    if (redraw == Redraw::kParts) clear(commands, kDepth, vk::ClearDepthStencilValue{1.0F, 0}, part);
    const PanelSets& sets = slot.panels[i];
    const auto paged = pagedOf(p);
    const std::size_t all = p.choice->patches.size(), whole = p.variant.holes ? p.choice->whole : all;
    if (whole > 0)
      instances(commands, pipelines_.depth({Geometry::Kind::kPatches, paged, Pipelines::Holes::kNo}),
                *sets.surface, gpu::kPatchVertices, 0, whole);
    if (whole < all)
      instances(commands, pipelines_.depth({Geometry::Kind::kPatches, paged, Pipelines::Holes::kYes}),
                *sets.surface, gpu::kPatchVertices, whole, all - whole);
    if (!p.choice->seams.empty())
      instances(commands, pipelines_.depth({Geometry::Kind::kSeams, paged, holesOf(p)}), *sets.seams,
                gpu::kSeamStripVertices, 0, 2 * p.choice->seams.size());
  }
  commands.endRendering();
}

void LiveFrame::recordBase(const vk::raii::CommandBuffer& commands, const Slot& slot,
                           std::span<const LivePanel> panels, const std::vector<gpu::Quad>& furniture,
                           const glm::vec3& ground, Redraw redraw) {
  const vk::ClearColorValue nothing(std::array<float, 4>{ground.x, ground.y, ground.z, 1.0F});
  const vk::RenderingAttachmentInfo cleared =
      attachment(base_.view(), ImageLayout::eColorAttachmentOptimal, loadOf(redraw), nothing);
  vk::RenderingInfo rendering;
  const vk::RenderingAttachmentInfo read =
      attachment(depth_.view(), ImageLayout::eDepthReadOnlyOptimal, vk::AttachmentLoadOp::eLoad);
  rendering.setRenderArea({{0, 0}, base_.extent()})
      .setLayerCount(1)
      .setViewMask(view_mask_)
      .setColorAttachments(cleared)
      .setPDepthAttachment(&read);
  commands.beginRendering(rendering);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const Rectangle& part = partOf(panels[i], redraw);
    if (empty(part)) continue;
    beginPanel(commands, panels[i], part);
    if (redraw == Redraw::kParts) clear(commands, kColour, nothing, part);
    instances(commands, pipelines_.shade(panels[i].variant), *slot.panels[i].surface, 4, 0, 1);
  }
  commands.endRendering();

  Changes again;
  again.add(depth_.image(), kDepth, ImageLayout::eDepthReadOnlyOptimal, ImageLayout::eDepthAttachmentOptimal,
            kDepthStages | Stage::eFragmentShader, Access::eShaderRead, kDepthStages, kDepthAccess);
  again.add(base_.image(), kColour, ImageLayout::eColorAttachmentOptimal,
            ImageLayout::eColorAttachmentOptimal, Stage::eColorAttachmentOutput,
            Access::eColorAttachmentWrite, Stage::eColorAttachmentOutput, kColourAccess);
  again.record(commands);
  const vk::RenderingAttachmentInfo colour =
      attachment(base_.view(), ImageLayout::eColorAttachmentOptimal, vk::AttachmentLoadOp::eLoad);
  const vk::RenderingAttachmentInfo depth =
      attachment(depth_.view(), ImageLayout::eDepthAttachmentOptimal, vk::AttachmentLoadOp::eLoad);
  rendering.setColorAttachments(colour).setPDepthAttachment(&depth);
  commands.beginRendering(rendering);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const LivePanel& p = panels[i];
    const Rectangle& part = partOf(p, redraw);
    if (empty(part)) continue;
    beginPanel(commands, p, part);
    // The plate is seen through holes alone.
    if (p.variant.holes) instances(commands, pipelines_.floor(), *slot.panels[i].surface, 4, 0, 1);
    if (!p.choice->walls.empty())
      instances(commands, pipelines_.wall(pagedOf(p), holesOf(p)), *slot.panels[i].walls, gpu::kWallVertices,
                0, p.choice->walls.size());
  }
  commands.endRendering();
  if (furniture.empty()) return;

  Changes over;
  over.add(base_.image(), kColour, ImageLayout::eColorAttachmentOptimal, ImageLayout::eColorAttachmentOptimal,
           Stage::eColorAttachmentOutput, Access::eColorAttachmentWrite, Stage::eColorAttachmentOutput,
           kColourAccess);
  over.record(commands);
  rendering.setPDepthAttachment(nullptr);
  commands.beginRendering(rendering);
  const vk::Extent2D extent = base_.extent();
  commands.setViewport(0, vk::Viewport{0.0F, 0.0F, static_cast<float>(extent.width),
                                       static_cast<float>(extent.height), 0.0F, 1.0F});
  commands.setScissor(0, vk::Rect2D{{0, 0}, extent});
  commands.bindPipeline(kGraphics, pipelines_.quads());
  const gpu::vec4 size{extent.width, extent.height, 0, 0};
  commands.pushConstants<gpu::vec4>(pipelines_.pictureLayout(), vk::ShaderStageFlagBits::eVertex, 0, size);
  commands.bindDescriptorSets(kGraphics, pipelines_.pictureLayout(), 0, *slot.picture, {});
  const auto quads = static_cast<std::uint32_t>(furniture.size());
  if (redraw == Redraw::kAll) commands.draw(4, quads, 0, 0);
  // Drawn over what is new alone: over what is there already its soft edges would grow.
  for (const LivePanel& p : panels)
    if (redraw == Redraw::kParts && !empty(p.redraw)) {
      commands.setScissor(0, rectOf(p.redraw));
      commands.draw(4, quads, 0, 0);
    }
  commands.endRendering();
}

void LiveFrame::recordTarget(const vk::raii::CommandBuffer& commands, const Slot& slot,
                             std::span<const LivePanel> panels, const LiveTarget& target) {
  vk::ImageCopy copy;
  copy.setSrcSubresource({kColour, 0, 0, layers_})
      .setDstSubresource({kColour, 0, 0, layers_})
      .setExtent({target.extent.width, target.extent.height, 1});
  commands.copyImage(base_.image(), ImageLayout::eTransferSrcOptimal, target.image,
                     ImageLayout::eTransferDstOptimal, copy);
  const bool lines = std::any_of(panels.begin(), panels.end(), [](const LivePanel& p) {
    return !empty(p.visible) && !(p.in_scene.empty() && p.on_top.empty());
  });
  const bool copied = target.leaves_as == ImageLayout::eTransferSrcOptimal;
  const vk::PipelineStageFlags2 next = copied ? Stage::eCopy : Stage::eBottomOfPipe;
  const auto reads = copied ? vk::AccessFlags2(Access::eTransferRead) : vk::AccessFlags2{};
  if (!lines && !target.over) {
    change(commands, target.image, ImageLayout::eTransferDstOptimal, target.leaves_as, Stage::eCopy,
           Access::eTransferWrite, next, reads);
    return;
  }
  change(commands, target.image, ImageLayout::eTransferDstOptimal, ImageLayout::eColorAttachmentOptimal,
         Stage::eCopy, Access::eTransferWrite, Stage::eColorAttachmentOutput, kColourAccess);
  const vk::RenderingAttachmentInfo colour =
      attachment(target.view, ImageLayout::eColorAttachmentOptimal, vk::AttachmentLoadOp::eLoad);
  const vk::RenderingAttachmentInfo depth =
      attachment(depth_.view(), ImageLayout::eDepthAttachmentOptimal, vk::AttachmentLoadOp::eLoad);
  vk::RenderingInfo rendering;
  rendering.setRenderArea({{0, 0}, target.extent})
      .setLayerCount(1)
      .setViewMask(view_mask_)
      .setColorAttachments(colour);
  if (lines) {
    rendering.setPDepthAttachment(&depth);
    commands.beginRendering(rendering);
    for (std::size_t i = 0; i < panels.size(); ++i) {
      const LivePanel& p = panels[i];
      if (empty(p.visible)) continue;
      beginPanel(commands, p, p.visible);
      if (!p.in_scene.empty())
        instances(commands, pipelines_.lines(Pipelines::Lines::kInScene), *slot.panels[i].in_scene, 4, 0,
                  p.in_scene.size());
      if (!p.on_top.empty())
        instances(commands, pipelines_.lines(Pipelines::Lines::kOnTop), *slot.panels[i].on_top, 4, 0,
                  p.on_top.size());
    }
    commands.endRendering();
  }
  if (target.over) {
    if (lines)
      change(commands, target.image, ImageLayout::eColorAttachmentOptimal,
             ImageLayout::eColorAttachmentOptimal, Stage::eColorAttachmentOutput,
             Access::eColorAttachmentWrite, Stage::eColorAttachmentOutput, kColourAccess);
    rendering.setPDepthAttachment(nullptr);
    commands.beginRendering(rendering);
    target.over(*commands);
    commands.endRendering();
  }
  change(commands, target.image, ImageLayout::eColorAttachmentOptimal, target.leaves_as,
         Stage::eColorAttachmentOutput, Access::eColorAttachmentWrite, next, reads);
}

void LiveFrame::record(Submissions& submissions, StagingRing& staging, std::span<const LivePanel> panels,
                       const std::vector<gpu::Quad>& furniture, const glm::vec3& ground, const Glyphs& glyphs,
                       const LiveTarget& target, Redraw redraw) {
  const vk::raii::CommandBuffer& commands = submissions.commands();
  Slot& slot = slots_[submissions.next() % Submissions::kInFlight];
  if (!furniture.empty()) bringGlyphs(commands, staging, submissions.next(), glyphs);
  makeLayers(submissions, target.extent);
  fill(slot, panels, furniture);

  const bool all = redraw == Redraw::kAll;
  const bool anew =
      all || std::any_of(panels.begin(), panels.end(), [](const LivePanel& p) { return !empty(p.redraw); });
  Changes compose;
  if (anew) {
    // The frame before may still draw lines against this depth, and copy out of that base.
    Changes begin;
    begin.add(depth_.image(), kDepth, all ? ImageLayout::eUndefined : ImageLayout::eDepthAttachmentOptimal,
              ImageLayout::eDepthAttachmentOptimal, kDepthStages, Access::eDepthStencilAttachmentWrite,
              kDepthStages, kDepthAccess);
    begin.record(commands);
    recordDepth(commands, slot, panels, redraw);
    Changes shade;
    shade.add(depth_.image(), kDepth, ImageLayout::eDepthAttachmentOptimal,
              ImageLayout::eDepthReadOnlyOptimal, kDepthStages, Access::eDepthStencilAttachmentWrite,
              kDepthStages | Stage::eFragmentShader,
              Access::eDepthStencilAttachmentRead | Access::eShaderRead);
    shade.add(base_.image(), kColour, all ? ImageLayout::eUndefined : ImageLayout::eTransferSrcOptimal,
              ImageLayout::eColorAttachmentOptimal, Stage::eCopy, Access::eTransferRead,
              Stage::eColorAttachmentOutput, kColourAccess);
    shade.record(commands);
    recordBase(commands, slot, panels, furniture, ground, redraw);
    compose.add(base_.image(), kColour, ImageLayout::eColorAttachmentOptimal,
                ImageLayout::eTransferSrcOptimal, Stage::eColorAttachmentOutput,
                Access::eColorAttachmentWrite, Stage::eCopy, Access::eTransferRead);
  }
  // The acquired image is waited for at these stages: the change of layout comes after it.
  compose.add(target.image, kColour, ImageLayout::eUndefined, ImageLayout::eTransferDstOptimal,
              Stage::eColorAttachmentOutput | Stage::eCopy, {}, Stage::eCopy, Access::eTransferWrite);
  compose.record(commands);
  recordTarget(commands, slot, panels, target);
}

}  // namespace fettle::render
