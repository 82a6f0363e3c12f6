#include "render/live/live_frame.h"
#include "render/live/panel_pass.h"
#include "render/vulkan/barrier.h"
#include "render/vulkan/descriptor_writes.h"

#include <algorithm>
#include <bit>

namespace fettle::render {
namespace {

constexpr auto kGraphics = vk::PipelineBindPoint::eGraphics;

// Whether what the frame before has left of depth, or of the colours, stays outside of the parts.
bool keepsDepth(LiveFrame::Redraw redraw) {
  return redraw == LiveFrame::Redraw::kParts;
}
bool keepsColours(LiveFrame::Redraw redraw) {
  return redraw == LiveFrame::Redraw::kParts || redraw == LiveFrame::Redraw::kFirstPartOver;
}
vk::AttachmentLoadOp loadOf(bool keeps) {
  return keeps ? vk::AttachmentLoadOp::eLoad : vk::AttachmentLoadOp::eClear;
}

Pipelines::Paged pagedOf(const LivePanel& p) {
  return p.variant.on_demand ? Pipelines::Paged::kByNeed
         : p.variant.paged   ? Pipelines::Paged::kYes
                             : Pipelines::Paged::kNo;
}
Pipelines::Holes holesOf(const LivePanel& p) {
  return p.variant.holes ? Pipelines::Holes::kYes : Pipelines::Holes::kNo;
}

const Rectangle& partOf(const LivePanel& p, LiveFrame::Redraw redraw) {
  return redraw == LiveFrame::Redraw::kAll ? p.visible : p.redraw;
}

// Clears a part of the attachment of the current rendering.
void clear(const vk::raii::CommandBuffer& commands, vk::ImageAspectFlags aspect, const vk::ClearValue& value,
           const Rectangle& part) {
  commands.clearAttachments(vk::ClearAttachment{aspect, 0, value}, vk::ClearRect{rectOf(part), 0, 1});
}

}  // namespace

LiveFrame::LiveFrame(Context& context, vk::Format colour, Pipelines::Views views,
                     std::shared_ptr<LivePrograms> programs)
    : context_(context),
      eyes_(views == Pipelines::Views::kBoth ? 2 : 1),
      view_mask_(views == Pipelines::Views::kBoth ? gpu::kBothViews : 0),
      programs_(std::move(programs)),
      pipelines_(programs_->pipelines()),
      stylus_(pipelines_, view_mask_),
      layers_(context, colour, eyes_, *programs_),
      glyphs_(context) {
  constexpr auto kSlots = static_cast<std::uint32_t>(Submissions::kInFlight);
  constexpr std::uint32_t kSets = kSlots * (6 * kMostPanels + 1);
  const std::array sizes{vk::DescriptorPoolSize{vk::DescriptorType::eUniformBuffer, kSets},
                         vk::DescriptorPoolSize{vk::DescriptorType::eSampledImage, 5 * kSets},
                         vk::DescriptorPoolSize{vk::DescriptorType::eStorageBuffer, 3 * kSets},
                         vk::DescriptorPoolSize{vk::DescriptorType::eSampler, kSets},
                         vk::DescriptorPoolSize{vk::DescriptorType::eUniformTexelBuffer, kSets}};
  vk::DescriptorPoolCreateInfo info{vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, kSets};
  pool_ = vk::raii::DescriptorPool(context.device(), info.setPoolSizes(sizes));
  const auto setOf = [&](vk::DescriptorSetLayout layout) {
    vk::DescriptorSetAllocateInfo allocate{*pool_};
    return std::move(vk::raii::DescriptorSets(context.device(), allocate.setSetLayouts(layout)).front());
  };
  no_pages_ = Buffer(context, Packing::kAlign, vk::BufferUsageFlagBits::eUniformTexelBuffer);
  no_pages_view_ = vk::raii::BufferView(context.device(),
                                        {{}, *no_pages_.handle(), vk::Format::eR32Uint, 0, VK_WHOLE_SIZE});
  for (Slot& slot : slots_) {
    for (PanelSets& p : slot.panels)
      for (vk::raii::DescriptorSet* set : {&p.surface, &p.seams, &p.walls, &p.in_scene, &p.on_top, &p.stylus})
        *set = setOf(pipelines_.sceneSet());
    slot.picture = setOf(pipelines_.pictureSet());
  }
}

std::array<vk::DescriptorSet, kMostPanels> LiveFrame::Slot::styluses() const {
  std::array<vk::DescriptorSet, kMostPanels> sets;
  std::ranges::transform(panels, sets.begin(), [](const PanelSets& p) { return *p.stylus; });
  return sets;
}

void LiveFrame::fill(Slot& slot, std::span<const LivePanel> panels, const std::vector<gpu::Quad>& decorations,
                     const Surface& surface, const GpuImage& under_stylus) {
  Packing packing;
  struct Blocks {
    Packing::Block uniforms, patches, seams, walls, in_scene, on_top, pages, stylus;
  };
  std::vector<Blocks> blocks;
  for (const LivePanel& p : panels)
    blocks.push_back({packing.add<gpu::PanelUniforms>(std::span(&p.uniforms, 1)),
                      packing.add<gpu::Patch>(p.choice->patches),
                      packing.add<gpu::Patch>(p.choice->seams),
                      packing.add<gpu::Patch>(p.choice->walls),
                      packing.add<gpu::Line>(p.in_scene),
                      packing.add<gpu::Line>(p.on_top),
                      packing.addTexels(p.pages),
                      {}});
  for (std::size_t i = 0; i < panels.size(); ++i)
    if (panels[i].stylus) blocks[i].stylus = packing.add<gpu::Stylus>(std::span(&*panels[i].stylus, 1));
  const auto quads = packing.add<gpu::Quad>(decorations);
  if (slot.arena.bytes() < packing.bytes())
    // A power of two always: pages are read from it as from an image, see choosePool().
    slot.arena = Buffer(context_, std::bit_ceil(std::max<vk::DeviceSize>(2 * packing.bytes(), kArenaBytes)),
                        vk::BufferUsageFlagBits::eUniformBuffer | vk::BufferUsageFlagBits::eStorageBuffer |
                            vk::BufferUsageFlagBits::eUniformTexelBuffer);
  packing.write(slot.arena.data());

  DescriptorWrites writes;
  constexpr auto kUniform = vk::DescriptorType::eUniformBuffer, kStorage = vk::DescriptorType::eStorageBuffer;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const LivePanel& p = panels[i];
    PanelSets& sets = slot.panels[i];
    if (p.variant.on_demand)
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
      writes.texels(set, gpu::kBindPages, p.variant.on_demand ? *sets.pages : *no_pages_view_);
    }
    writes.image(*sets.surface, gpu::kBindDepth, surface.depth.view(), ImageLayout::eDepthReadOnlyOptimal);
    if (p.stylus) {
      writes.buffer(*sets.stylus, gpu::kBindPanel, kUniform, slot.arena, blocks[i].uniforms);
      writes.buffer(*sets.stylus, gpu::kBindStylus, kStorage, slot.arena, blocks[i].stylus);
      writes.image(*sets.stylus, gpu::kBindDepth, under_stylus.view(), ImageLayout::eDepthReadOnlyOptimal);
    }
    for (const auto& [set, list] :
         {std::pair{*sets.in_scene, blocks[i].in_scene}, {*sets.on_top, blocks[i].on_top}}) {
      writes.buffer(set, gpu::kBindPanel, kUniform, slot.arena, blocks[i].uniforms);
      writes.buffer(set, gpu::kBindLines, kStorage, slot.arena, list);
    }
  }
  if (!decorations.empty()) {
    writes.image(*slot.picture, gpu::kBindGlyphs, glyphs_.view());
    writes.buffer(*slot.picture, gpu::kBindQuads, kStorage, slot.arena, quads);
    writes.buffer(*slot.picture, gpu::kBindMap, kUniform, slot.arena, blocks.front().uniforms);
  }
  writes.apply(context_.device());
}

void LiveFrame::recordDepth(const vk::raii::CommandBuffer& commands, const Slot& slot,
                            std::span<const LivePanel> panels, const Surface& surface, Redraw redraw) {
  const PanelDraws draws(commands, pipelines_.sceneLayout());
  using Geometry = Pipelines::Geometry;
  const vk::RenderingAttachmentInfo depth =
      attachment(surface.depth.view(), ImageLayout::eDepthAttachmentOptimal, loadOf(keepsDepth(redraw)),
                 vk::ClearDepthStencilValue{1.0F, 0});
  vk::RenderingInfo rendering;
  rendering.setRenderArea({{0, 0}, surface.depth.extent()})
      .setLayerCount(1)
      .setViewMask(view_mask_)
      .setPDepthAttachment(&depth);
  commands.beginRendering(rendering);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const LivePanel& p = panels[i];
    const Rectangle& part = partOf(p, redraw);
    if (empty(part)) continue;
    draws.begin(p, part, surface.scale);
    if (keepsDepth(redraw))
      clear(commands, kDepth, vk::ClearDepthStencilValue{1.0F, 0}, scaled(part, surface.scale));
    const PanelSets& sets = slot.panels[i];
    const auto paged = pagedOf(p);
    const std::size_t all = p.choice->patches.size(), whole = p.variant.holes ? p.choice->whole : all;
    if (whole > 0)
      draws.instances(pipelines_.of(Geometry{Geometry::Kind::kPatches, paged, Pipelines::Holes::kNo}),
                      *sets.surface, gpu::kPatchVertices, 0, whole);
    if (whole < all)
      draws.instances(pipelines_.of(Geometry{Geometry::Kind::kPatches, paged, Pipelines::Holes::kYes}),
                      *sets.surface, gpu::kPatchVertices, whole, all - whole);
    if (!p.choice->seams.empty())
      draws.instances(pipelines_.of(Geometry{Geometry::Kind::kSeams, paged, holesOf(p)}), *sets.seams,
                      gpu::kSeamStripVertices, 0, 2 * p.choice->seams.size());
  }
  commands.endRendering();
}

void LiveFrame::recordBase(const vk::raii::CommandBuffer& commands, const Slot& slot,
                           std::span<const LivePanel> panels, const glm::vec3& ground, const Surface& surface,
                           Redraw redraw, HiddenLines lines) {
  const PanelDraws draws(commands, pipelines_.sceneLayout());
  const vk::ClearColorValue nothing(std::array<float, 4>{ground.x, ground.y, ground.z, 1.0F});
  const vk::RenderingAttachmentInfo cleared = attachment(
      surface.base.view(), ImageLayout::eColorAttachmentOptimal, loadOf(keepsColours(redraw)), nothing);
  vk::RenderingInfo rendering;
  const vk::RenderingAttachmentInfo read =
      attachment(surface.depth.view(), ImageLayout::eDepthReadOnlyOptimal, vk::AttachmentLoadOp::eLoad);
  rendering.setRenderArea({{0, 0}, surface.depth.extent()})
      .setLayerCount(1)
      .setViewMask(view_mask_)
      .setColorAttachments(cleared)
      .setPDepthAttachment(&read);
  commands.beginRendering(rendering);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const Rectangle& part = partOf(panels[i], redraw);
    if (empty(part)) continue;
    draws.begin(panels[i], part, surface.scale);
    if (keepsColours(redraw)) clear(commands, kColour, nothing, scaled(part, surface.scale));
    draws.instances(pipelines_.of(panels[i].variant), *slot.panels[i].surface, 4, 0, 1);
  }
  commands.endRendering();

  Barriers again;
  again.add(surface.depth.image(), kDepth,
            {ImageLayout::eDepthReadOnlyOptimal, kDepthStages | Stage::eFragmentShader, Access::eShaderRead},
            {ImageLayout::eDepthAttachmentOptimal, kDepthStages, kDepthAccess});
  again.add(surface.base.image(), kColour, kColourWritten, kColourUsed);
  again.record(commands);
  const vk::RenderingAttachmentInfo colour =
      attachment(surface.base.view(), ImageLayout::eColorAttachmentOptimal, vk::AttachmentLoadOp::eLoad);
  const vk::RenderingAttachmentInfo depth =
      attachment(surface.depth.view(), ImageLayout::eDepthAttachmentOptimal, vk::AttachmentLoadOp::eLoad);
  rendering.setColorAttachments(colour).setPDepthAttachment(&depth);
  commands.beginRendering(rendering);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const LivePanel& p = panels[i];
    const Rectangle& part = partOf(p, redraw);
    if (empty(part)) continue;
    draws.begin(p, part, surface.scale);
    // The plate is only visible through holes.
    if (p.variant.holes)
      draws.instances(pipelines_.of(Pipelines::Flat::kFloor), *slot.panels[i].surface, 4, 0, 1);
    if (!p.choice->walls.empty())
      draws.instances(pipelines_.of(Pipelines::Wall{pagedOf(p), holesOf(p)}), *slot.panels[i].walls,
                      gpu::kWallVertices, 0, p.choice->walls.size());
  }
  // Over the copy they move without shading the surface again.
  if (lines == HiddenLines::kInBase)
    recordLines(commands, slot, panels, Pipelines::Lines::kInScene, surface.scale);
  commands.endRendering();
  if (lines == HiddenLines::kInBase && StylusPass::neededBy(panels))
    stylus_.record(commands, panels, slot.styluses(),
                   {surface.depth, surface.base.view(), surface.base.image(), surface.scale});
}

void LiveFrame::recordLines(const vk::raii::CommandBuffer& commands, const Slot& slot,
                            std::span<const LivePanel> panels, Pipelines::Lines depth, float scale) {
  const PanelDraws draws(commands, pipelines_.sceneLayout());
  const bool in_scene = depth == Pipelines::Lines::kInScene;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const LivePanel& p = panels[i];
    const std::vector<gpu::Line>& lines = in_scene ? p.in_scene : p.on_top;
    const Rectangle& part = in_scene ? p.tested : p.visible;
    if (empty(part) || lines.empty()) continue;
    draws.begin(p, part, scale);
    draws.instances(pipelines_.of(depth), in_scene ? *slot.panels[i].in_scene : *slot.panels[i].on_top, 4, 0,
                    lines.size());
  }
}

void LiveFrame::recordDecorations(const vk::raii::CommandBuffer& commands, const Slot& slot,
                                  std::span<const LivePanel> panels,
                                  const std::vector<gpu::Quad>& decorations, const GpuImage& base,
                                  Redraw redraw) {
  if (decorations.empty()) return;
  Barriers over;
  over.add(base.image(), kColour, kColourWritten, kColourUsed);
  over.record(commands);
  const vk::Extent2D extent = layers_.whole().picture;
  const vk::RenderingAttachmentInfo colour =
      attachment(base.view(), ImageLayout::eColorAttachmentOptimal, vk::AttachmentLoadOp::eLoad);
  vk::RenderingInfo rendering;
  rendering.setRenderArea({{0, 0}, extent})
      .setLayerCount(1)
      .setViewMask(view_mask_)
      .setColorAttachments(colour);
  commands.beginRendering(rendering);
  commands.setViewport(0, vk::Viewport{0.0F, 0.0F, static_cast<float>(extent.width),
                                       static_cast<float>(extent.height), 0.0F, 1.0F});
  commands.setScissor(0, vk::Rect2D{{0, 0}, extent});
  commands.bindPipeline(kGraphics, pipelines_.of(Pipelines::Flat::kQuads));
  const gpu::vec4 size{extent.width, extent.height, 0, 0};
  commands.pushConstants<gpu::vec4>(pipelines_.pictureLayout(), vk::ShaderStageFlagBits::eVertex, 0, size);
  commands.bindDescriptorSets(kGraphics, pipelines_.pictureLayout(), 0, *slot.picture, {});
  const auto quads = static_cast<std::uint32_t>(decorations.size());
  if (redraw == Redraw::kAll) commands.draw(4, quads, 0, 0);
  // Only over what was drawn again: over older pixels the soft edges would be blended twice.
  for (const LivePanel& p : panels)
    if (keepsColours(redraw) && !empty(p.redraw)) {
      commands.setScissor(0, rectOf(p.redraw));
      commands.draw(4, quads, 0, 0);
    }
  commands.endRendering();
}

void LiveFrame::recordTarget(const vk::raii::CommandBuffer& commands, const Slot& slot,
                             std::span<const LivePanel> panels, const BaseCopy& copied_base,
                             const LiveTarget& target, Sharpness sharpness) {
  if (copied_base.places.empty()) return;               // and there is no overlay
  const bool in_scene = sharpness == Sharpness::kFull;  // lines of that kind are still to be drawn
  // The acquired image is waited for at these stages: the change of layout comes after it.
  Barriers begin;
  begin.add(target.image, kColour,
            {copied_base.over_before ? target.leaves_as : ImageLayout::eUndefined,
             Stage::eColorAttachmentOutput | Stage::eCopy,
             {}},
            {ImageLayout::eTransferDstOptimal, Stage::eCopy, Access::eTransferWrite});
  begin.record(commands);
  std::vector<vk::ImageCopy> copies;
  copies.reserve(copied_base.places.size());
  for (const Rectangle& place : copied_base.places) {
    const vk::Offset3D from{place.x, place.y, 0};
    copies.push_back(
        {{kColour, 0, 0, eyes_},
         from,
         {kColour, 0, 0, eyes_},
         from,
         {static_cast<std::uint32_t>(place.width), static_cast<std::uint32_t>(place.height), 1}});
  }
  commands.copyImage(copied_base.base.image(), ImageLayout::eTransferSrcOptimal, target.image,
                     ImageLayout::eTransferDstOptimal, copies);
  const bool lines = std::any_of(panels.begin(), panels.end(), [&](const LivePanel& p) {
    return (in_scene && !empty(p.tested) && !p.in_scene.empty()) || (!empty(p.visible) && !p.on_top.empty());
  });
  const bool copied = target.leaves_as == ImageLayout::eTransferSrcOptimal;
  const vk::PipelineStageFlags2 next = copied ? Stage::eCopy : Stage::eBottomOfPipe;
  const auto reads = copied ? vk::AccessFlags2(Access::eTransferRead) : vk::AccessFlags2{};
  const bool stylus = in_scene && StylusPass::neededBy(panels);
  if (!lines && !stylus && !target.over) {
    change(commands, target.image, ImageLayout::eTransferDstOptimal, target.leaves_as, Stage::eCopy,
           Access::eTransferWrite, next, reads);
    return;
  }
  change(commands, target.image, ImageLayout::eTransferDstOptimal, ImageLayout::eColorAttachmentOptimal,
         Stage::eCopy, Access::eTransferWrite, Stage::eColorAttachmentOutput, kColourAccess);
  const vk::RenderingAttachmentInfo colour =
      attachment(target.view, ImageLayout::eColorAttachmentOptimal, vk::AttachmentLoadOp::eLoad);
  // Except at full sharpness the depth is empty, and lines on top do not test it.
  const vk::RenderingAttachmentInfo depth =
      attachment(layers_.whole().depth.view(), ImageLayout::eDepthAttachmentOptimal,
                 in_scene ? vk::AttachmentLoadOp::eLoad : vk::AttachmentLoadOp::eDontCare);
  vk::RenderingInfo rendering;
  rendering.setRenderArea({{0, 0}, target.extent})
      .setLayerCount(1)
      .setViewMask(view_mask_)
      .setColorAttachments(colour);
  if (lines || stylus) {
    if (!in_scene)
      change(commands, layers_.whole().depth, ImageLayout::eUndefined, ImageLayout::eDepthAttachmentOptimal,
             kDepthStages, kDepthAccess, kDepthStages, kDepthAccess);
    rendering.setPDepthAttachment(&depth);
    commands.beginRendering(rendering);
    if (in_scene) recordLines(commands, slot, panels, Pipelines::Lines::kInScene, 1.0F);
    if (stylus) {
      commands.endRendering();
      stylus_.record(commands, panels, slot.styluses(), {layers_.whole().depth, target.view, target.image});
      commands.beginRendering(rendering);
    }
    recordLines(commands, slot, panels, Pipelines::Lines::kOnTop, 1.0F);
    commands.endRendering();
  }
  if (target.over) {
    if (lines || stylus)
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

void LiveFrame::recordSurface(const vk::raii::CommandBuffer& commands, const Slot& slot,
                              std::span<const LivePanel> panels, const glm::vec3& ground,
                              const Surface& surface, Redraw redraw, const Before& before) {
  Barriers begin;
  begin.add(surface.depth.image(), kDepth,
            {keepsDepth(redraw) ? ImageLayout::eDepthAttachmentOptimal : ImageLayout::eUndefined,
             kDepthStages, Access::eDepthStencilAttachmentWrite},
            {ImageLayout::eDepthAttachmentOptimal, kDepthStages, kDepthAccess});
  begin.record(commands);
  recordDepth(commands, slot, panels, surface, redraw);
  Barriers shade;
  shade.add(surface.depth.image(), kDepth,
            {ImageLayout::eDepthAttachmentOptimal, kDepthStages, Access::eDepthStencilAttachmentWrite},
            {ImageLayout::eDepthReadOnlyOptimal, kDepthStages | Stage::eFragmentShader,
             Access::eDepthStencilAttachmentRead | Access::eShaderRead});
  Barriers::Access base = before.base;
  if (!keepsColours(redraw)) base.layout = ImageLayout::eUndefined;
  shade.add(surface.base.image(), kColour, base, kColourUsed);
  shade.record(commands);
  recordBase(commands, slot, panels, ground, surface, redraw, before.lines);
}

std::vector<Rectangle> LiveFrame::record(Submissions& submissions, StagingRing& staging,
                                         std::span<const LivePanel> panels,
                                         const std::vector<gpu::Quad>& decorations, const glm::vec3& ground,
                                         const Glyphs& glyphs, const LiveTarget& target, Redraw redraw,
                                         Sharpness sharpness) {
  const vk::raii::CommandBuffer& commands = submissions.commands();
  Slot& slot = slots_[submissions.next() % Submissions::kInFlight];
  if (!decorations.empty()) glyphs_.upload(commands, staging, submissions.next(), glyphs);
  layers_.prepare(submissions, target.extent, sharpness);
  const Surface &surface = layers_.of(sharpness), &whole = layers_.whole();
  const bool resized = &surface != &whole;
  fill(slot, panels, decorations, surface, surface.depth);

  const bool all = redraw == Redraw::kAll;
  const bool redraws =
      all || std::any_of(panels.begin(), panels.end(), [](const LivePanel& p) { return !empty(p.redraw); });
  const Barriers::Access copied{ImageLayout::eTransferSrcOptimal, Stage::eCopy, Access::eTransferRead};
  const Barriers::Access read{ImageLayout::eShaderReadOnlyOptimal, Stage::eFragmentShader,
                              Access::eShaderRead};
  std::optional<Places> changed = Places();  // of the base
  if (redraws) {
    // The previous frame may still draw lines against this depth and copy from that base.
    recordSurface(
        commands, slot, panels, ground, surface, redraw,
        {.base = resized ? read : copied, .lines = resized ? HiddenLines::kInBase : HiddenLines::kOverCopy});
    if (resized) layers_.recordResized(commands, surface, panels, ground);
    recordDecorations(commands, slot, panels, decorations, whole.base, redraw);
    Barriers compose;
    compose.add(whole.base.image(), kColour, kColourWritten, copied);
    compose.record(commands);
    if (keepsColours(redraw))
      for (const LivePanel& panel : panels) changed->add(panel.redraw);
    else
      changed.reset();
  }
  BaseCopy copy = kept_.copyTo(target, whole.base, panels, std::move(changed));
  recordTarget(commands, slot, panels, copy, target, sharpness);
  return std::move(copy.places);
}

std::vector<Rectangle> LiveFrame::recordRest(Submissions& submissions, StagingRing& staging,
                                             std::span<const LivePanel> panels,
                                             const std::vector<gpu::Quad>& decorations,
                                             const glm::vec3& ground, const Glyphs& glyphs,
                                             const LiveTarget& target, const Rest& rest) {
  const vk::raii::CommandBuffer& commands = submissions.commands();
  Slot& slot = slots_[submissions.next() % Submissions::kInFlight];
  if (!decorations.empty()) glyphs_.upload(commands, staging, submissions.next(), glyphs);
  layers_.prepareRest(submissions, target.extent);
  const Surface &fine = layers_.of(Sharpness::kFine), &whole = layers_.whole();
  fill(slot, panels, decorations, fine, whole.depth);  // recordTarget() draws the stylus
  const Barriers::Access copied{ImageLayout::eTransferSrcOptimal, Stage::eCopy, Access::eTransferRead};
  if (rest.draws) {
    // The first part may follow a frame that still reduces what was there before.
    const Barriers::Access reduced{ImageLayout::eShaderReadOnlyOptimal, Stage::eFragmentShader,
                                   Access::eShaderRead};
    recordSurface(commands, slot, panels, ground, fine, rest.first ? Redraw::kFirstPart : Redraw::kParts,
                  {.base = rest.first ? reduced : kColourWritten, .lines = HiddenLines::kOverCopy});
    if (rest.last) {
      layers_.recordReducedToRest(commands);
      recordDecorations(commands, slot, panels, decorations, layers_.rest(), Redraw::kAll);
      Barriers compose;
      compose.add(layers_.rest().image(), kColour, kColourWritten, copied);
      compose.record(commands);
    }
  }
  BaseCopy copy = kept_.copyTo(target, rest.shows ? layers_.rest() : whole.base, panels, Places());
  recordTarget(commands, slot, panels, copy, target, Sharpness::kFull);
  return std::move(copy.places);
}

}  // namespace fettle::render
