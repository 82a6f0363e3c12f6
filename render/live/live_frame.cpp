#include "render/live/live_frame.h"
#include "render/live/overlay_places.h"
#include "render/live/panel_pass.h"
#include "render/plan/colour_map.h"
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

// The same bytes, read as code values and not as amounts of light.
vk::Format codesOf(vk::Format colour) {
  switch (colour) {
    case vk::Format::eR8G8B8A8Srgb:
      return vk::Format::eR8G8B8A8Unorm;
    case vk::Format::eB8G8R8A8Srgb:
      return vk::Format::eB8G8R8A8Unorm;
    default:
      return colour;
  }
}

// Values of LivePrograms::kEnlarged with which an image of the format has this colour [linear light].
vk::ClearColorValue codesOf(const glm::vec3& light, vk::Format colour) {
  const auto code = [](float channel) { return static_cast<float>(srgbFromLinear(channel)); };
  const bool red_first = codesOf(colour) == vk::Format::eR8G8B8A8Unorm;
  const float red = code(light.r), green = code(light.g), blue = code(light.b);
  return red_first ? std::array{blue, green, red, 1.0F} : std::array{red, green, blue, 1.0F};
}

// Every `step`-th pixel, rounded up: one pixel of the result is `step` of the whole in each direction.
vk::Extent2D everyNth(vk::Extent2D extent, std::uint32_t step) {
  return {(extent.width + step - 1) / step, (extent.height + step - 1) / step};
}
vk::Extent2D halfOf(vk::Extent2D extent) {
  return everyNth(extent, 2);
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
      colour_(colour),
      layers_(views == Pipelines::Views::kBoth ? 2 : 1),
      view_mask_(views == Pipelines::Views::kBoth ? gpu::kBothViews : 0),
      programs_(std::move(programs)),
      pipelines_(programs_->pipelines()),
      stylus_(pipelines_, view_mask_),
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

GpuImage LiveFrame::baseOf(vk::Extent2D extent) const {
  using Usage = vk::ImageUsageFlagBits;
  // Copied as code values.
  return GpuImage(context_, codesOf(colour_), extent, layers_,
                  layers_ == 1 ? GpuImage::Kind::kPlane : GpuImage::Kind::kArray,
                  Usage::eColorAttachment | Usage::eTransferSrc | Usage::eSampled, kColour, colour_);
}

void LiveFrame::makeLayer(Layers& layers, vk::Extent2D picture, vk::Extent2D size) {
  using Usage = vk::ImageUsageFlagBits;
  layers.extent = picture;
  layers.depth = GpuImage(context_, kDepthFormat, &layers == &whole_ ? picture : size, layers_,
                          layers_ == 1 ? GpuImage::Kind::kPlane : GpuImage::Kind::kArray,
                          Usage::eDepthStencilAttachment | Usage::eSampled, kDepth);
  layers.base = baseOf(size);
}

void LiveFrame::makeFine(vk::Extent2D extent) {
  const vk::Extent2D small = halfOf(extent);
  fine_.scale = 2.0F;
  makeLayer(fine_, extent, {4 * small.width, 4 * small.height});
}

void LiveFrame::makeRest(Submissions& submissions, vk::Extent2D extent) {
  if (rest_extent_ == extent && fine_.extent == extent) return;
  // The frame in flight draws with the old ones.
  submissions.finish();
  if (fine_.extent != extent) {
    makeFine(extent);
    if (reduce_) reduce_->set(fine_.base, whole_.base, layers_);
  }
  const vk::Extent2D small = halfOf(extent);
  rest_ = baseOf({2 * small.width, 2 * small.height});
  rest_extent_ = extent;
  if (!reduce_to_rest_)
    reduce_to_rest_ = std::make_unique<Resize>(context_, programs_->reduce(), Resize::Times::kTwo);
  reduce_to_rest_->set(fine_.base, rest_, layers_);
}

void LiveFrame::makeSmall(Layers& layers, vk::Extent2D picture, Resize::Times times,
                          std::unique_ptr<Resize>& enlarge) {
  const int step = times == Resize::Times::kTwo ? 2 : 4;
  layers.scale = 1.0F / static_cast<float>(step);
  makeLayer(layers, picture, everyNth(picture, static_cast<std::uint32_t>(step)));
  if (!enlarge) enlarge = std::make_unique<Resize>(context_, programs_->enlarge(), times);
  enlarge->set(layers.base, whole_.base, layers_);
}

void LiveFrame::makeLayers(Submissions& submissions, vk::Extent2D extent, Sharpness sharpness) {
  const bool half = sharpness == Sharpness::kHalf, quarter = sharpness == Sharpness::kQuarter,
             fine = sharpness == Sharpness::kFine;
  if (whole_.extent == extent && (!half || half_.extent == extent) &&
      (!quarter || quarter_.extent == extent) && (!fine || (fine_.extent == extent && reduce_)))
    return;
  // The frame in flight draws with the old ones.
  submissions.finish();
  if (whole_.extent != extent) {
    // Room for what is enlarged from every fourth pixel.
    const vk::Extent2D fourth = everyNth(extent, 4);
    makeLayer(whole_, extent, {4 * fourth.width, 4 * fourth.height});
    // What is resized into it is not that of before, however large: a size may come back.
    half_.extent = quarter_.extent = vk::Extent2D{};
    reduce_.reset();
  }
  if (half) makeSmall(half_, extent, Resize::Times::kTwo, enlarge_);
  if (quarter) makeSmall(quarter_, extent, Resize::Times::kFour, enlarge_more_);
  if (fine) {
    if (fine_.extent != extent) makeFine(extent);
    if (!reduce_) reduce_ = std::make_unique<Resize>(context_, programs_->reduce(), Resize::Times::kTwo);
    reduce_->set(fine_.base, whole_.base, layers_);
  }
}

void LiveFrame::fill(Slot& slot, std::span<const LivePanel> panels, const std::vector<gpu::Quad>& decorations,
                     const Layers& layers, const GpuImage& under_stylus) {
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
    writes.image(*sets.surface, gpu::kBindDepth, layers.depth.view(), ImageLayout::eDepthReadOnlyOptimal);
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
                            std::span<const LivePanel> panels, const Layers& layers, Redraw redraw) {
  const PanelDraws draws(commands, pipelines_.sceneLayout());
  using Geometry = Pipelines::Geometry;
  const vk::RenderingAttachmentInfo depth =
      attachment(layers.depth.view(), ImageLayout::eDepthAttachmentOptimal, loadOf(keepsDepth(redraw)),
                 vk::ClearDepthStencilValue{1.0F, 0});
  vk::RenderingInfo rendering;
  rendering.setRenderArea({{0, 0}, layers.depth.extent()})
      .setLayerCount(1)
      .setViewMask(view_mask_)
      .setPDepthAttachment(&depth);
  commands.beginRendering(rendering);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const LivePanel& p = panels[i];
    const Rectangle& part = partOf(p, redraw);
    if (empty(part)) continue;
    draws.begin(p, part, layers.scale);
    if (keepsDepth(redraw))
      clear(commands, kDepth, vk::ClearDepthStencilValue{1.0F, 0}, scaled(part, layers.scale));
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
                           std::span<const LivePanel> panels, const glm::vec3& ground, const Layers& layers,
                           Redraw redraw, HiddenLines lines) {
  const PanelDraws draws(commands, pipelines_.sceneLayout());
  const vk::ClearColorValue nothing(std::array<float, 4>{ground.x, ground.y, ground.z, 1.0F});
  const vk::RenderingAttachmentInfo cleared = attachment(
      layers.base.view(), ImageLayout::eColorAttachmentOptimal, loadOf(keepsColours(redraw)), nothing);
  vk::RenderingInfo rendering;
  const vk::RenderingAttachmentInfo read =
      attachment(layers.depth.view(), ImageLayout::eDepthReadOnlyOptimal, vk::AttachmentLoadOp::eLoad);
  rendering.setRenderArea({{0, 0}, layers.depth.extent()})
      .setLayerCount(1)
      .setViewMask(view_mask_)
      .setColorAttachments(cleared)
      .setPDepthAttachment(&read);
  commands.beginRendering(rendering);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const Rectangle& part = partOf(panels[i], redraw);
    if (empty(part)) continue;
    draws.begin(panels[i], part, layers.scale);
    if (keepsColours(redraw)) clear(commands, kColour, nothing, scaled(part, layers.scale));
    draws.instances(pipelines_.of(panels[i].variant), *slot.panels[i].surface, 4, 0, 1);
  }
  commands.endRendering();

  Barriers again;
  again.add(layers.depth.image(), kDepth,
            {ImageLayout::eDepthReadOnlyOptimal, kDepthStages | Stage::eFragmentShader, Access::eShaderRead},
            {ImageLayout::eDepthAttachmentOptimal, kDepthStages, kDepthAccess});
  again.add(layers.base.image(), kColour, kColourWritten, kColourUsed);
  again.record(commands);
  const vk::RenderingAttachmentInfo colour =
      attachment(layers.base.view(), ImageLayout::eColorAttachmentOptimal, vk::AttachmentLoadOp::eLoad);
  const vk::RenderingAttachmentInfo depth =
      attachment(layers.depth.view(), ImageLayout::eDepthAttachmentOptimal, vk::AttachmentLoadOp::eLoad);
  rendering.setColorAttachments(colour).setPDepthAttachment(&depth);
  commands.beginRendering(rendering);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const LivePanel& p = panels[i];
    const Rectangle& part = partOf(p, redraw);
    if (empty(part)) continue;
    draws.begin(p, part, layers.scale);
    // The plate is only visible through holes.
    if (p.variant.holes)
      draws.instances(pipelines_.of(Pipelines::Flat::kFloor), *slot.panels[i].surface, 4, 0, 1);
    if (!p.choice->walls.empty())
      draws.instances(pipelines_.of(Pipelines::Wall{pagedOf(p), holesOf(p)}), *slot.panels[i].walls,
                      gpu::kWallVertices, 0, p.choice->walls.size());
  }
  // Over the copy they move without shading the surface again.
  if (lines == HiddenLines::kInBase)
    recordLines(commands, slot, panels, Pipelines::Lines::kInScene, layers.scale);
  commands.endRendering();
  if (lines == HiddenLines::kInBase && StylusPass::neededBy(panels))
    stylus_.record(commands, panels, slot.styluses(),
                   {layers.depth, layers.base.view(), layers.base.image(), layers.scale});
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

void LiveFrame::beforeResize(const vk::raii::CommandBuffer& commands, const Layers& layers,
                             const GpuImage& to) {
  Barriers before;
  before.add(layers.base.image(), kColour, kColourWritten,
             {ImageLayout::eShaderReadOnlyOptimal, Stage::eFragmentShader, Access::eShaderRead});
  before.add(to.image(), kColour, {ImageLayout::eUndefined, Stage::eCopy, Access::eTransferRead},
             kColourUsed);
  before.record(commands);
}

// Outside of the panels is what a frame of every pixel leaves there: bands of it may follow. Grounds are whole codes, so that both
// ways of clearing give the same.
void LiveFrame::recordEnlarged(const vk::raii::CommandBuffer& commands, const Layers& layers,
                               std::span<const LivePanel> panels, const glm::vec3& ground) {
  beforeResize(commands, layers, whole_.base);
  std::vector<vk::Rect2D> parts;
  for (const LivePanel& panel : panels)
    if (!empty(panel.visible)) parts.push_back(rectOf(panel.visible));
  (&layers == &half_ ? enlarge_ : enlarge_more_)->record(commands, parts, codesOf(ground, colour_));
}

void LiveFrame::recordReduced(const vk::raii::CommandBuffer& commands, const Resize& reduce,
                              const GpuImage& to) {
  beforeResize(commands, fine_, to);
  reduce.record(commands);
}

void LiveFrame::recordDecorations(const vk::raii::CommandBuffer& commands, const Slot& slot,
                                  std::span<const LivePanel> panels,
                                  const std::vector<gpu::Quad>& decorations, const GpuImage& base,
                                  Redraw redraw) {
  if (decorations.empty()) return;
  Barriers over;
  over.add(base.image(), kColour, kColourWritten, kColourUsed);
  over.record(commands);
  const vk::Extent2D extent = whole_.extent;
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

LiveFrame::Copied LiveFrame::copiedTo(const LiveTarget& target, const GpuImage& base,
                                      std::span<const LivePanel> panels, std::optional<Places> changed) {
  const Rectangle all{0, 0, static_cast<int>(target.extent.width), static_cast<int>(target.extent.height)};
  const std::optional<Held> before = std::exchange(held_, std::nullopt);
  if (target.kept == 0 || layers_ > 1 || target.over) return {base, {all}};
  // All overlays are drawn again, each over what was copied below it.
  Places overlays;
  addOverlays(panels, overlays);
  held_ = Held{target.kept, target.image, target.extent, &base, overlays.take()};
  if (!changed || !before || before->kept != target.kept || before->image != target.image ||
      before->extent != target.extent || before->base != &base)
    return {base, {all}};
  for (const Rectangle& place : before->overlays) changed->add(place);
  for (const Rectangle& place : held_->overlays) changed->add(place);
  Copied copied{base, changed->take(), true};
  for (Rectangle& place : copied.places) place = cut(place, all);
  std::erase_if(copied.places, [](const Rectangle& place) { return empty(place); });
  return copied;
}

void LiveFrame::recordTarget(const vk::raii::CommandBuffer& commands, const Slot& slot,
                             std::span<const LivePanel> panels, const Copied& copied_base,
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
        {{kColour, 0, 0, layers_},
         from,
         {kColour, 0, 0, layers_},
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
      attachment(whole_.depth.view(), ImageLayout::eDepthAttachmentOptimal,
                 in_scene ? vk::AttachmentLoadOp::eLoad : vk::AttachmentLoadOp::eDontCare);
  vk::RenderingInfo rendering;
  rendering.setRenderArea({{0, 0}, target.extent})
      .setLayerCount(1)
      .setViewMask(view_mask_)
      .setColorAttachments(colour);
  if (lines || stylus) {
    if (!in_scene)
      change(commands, whole_.depth, ImageLayout::eUndefined, ImageLayout::eDepthAttachmentOptimal,
             kDepthStages, kDepthAccess, kDepthStages, kDepthAccess);
    rendering.setPDepthAttachment(&depth);
    commands.beginRendering(rendering);
    if (in_scene) recordLines(commands, slot, panels, Pipelines::Lines::kInScene, 1.0F);
    if (stylus) {
      commands.endRendering();
      stylus_.record(commands, panels, slot.styluses(), {whole_.depth, target.view, target.image});
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
                              const Layers& layers, Redraw redraw, const Before& before) {
  Barriers begin;
  begin.add(layers.depth.image(), kDepth,
            {keepsDepth(redraw) ? ImageLayout::eDepthAttachmentOptimal : ImageLayout::eUndefined,
             kDepthStages, Access::eDepthStencilAttachmentWrite},
            {ImageLayout::eDepthAttachmentOptimal, kDepthStages, kDepthAccess});
  begin.record(commands);
  recordDepth(commands, slot, panels, layers, redraw);
  Barriers shade;
  shade.add(layers.depth.image(), kDepth,
            {ImageLayout::eDepthAttachmentOptimal, kDepthStages, Access::eDepthStencilAttachmentWrite},
            {ImageLayout::eDepthReadOnlyOptimal, kDepthStages | Stage::eFragmentShader,
             Access::eDepthStencilAttachmentRead | Access::eShaderRead});
  Barriers::Access base = before.base;
  if (!keepsColours(redraw)) base.layout = ImageLayout::eUndefined;
  shade.add(layers.base.image(), kColour, base, kColourUsed);
  shade.record(commands);
  recordBase(commands, slot, panels, ground, layers, redraw, before.lines);
}

std::vector<Rectangle> LiveFrame::record(Submissions& submissions, StagingRing& staging,
                                         std::span<const LivePanel> panels,
                                         const std::vector<gpu::Quad>& decorations, const glm::vec3& ground,
                                         const Glyphs& glyphs, const LiveTarget& target, Redraw redraw,
                                         Sharpness sharpness) {
  const vk::raii::CommandBuffer& commands = submissions.commands();
  Slot& slot = slots_[submissions.next() % Submissions::kInFlight];
  if (!decorations.empty()) glyphs_.upload(commands, staging, submissions.next(), glyphs);
  makeLayers(submissions, target.extent, sharpness);
  const Layers& layers = sharpness == Sharpness::kHalf      ? half_
                         : sharpness == Sharpness::kQuarter ? quarter_
                         : sharpness == Sharpness::kFine    ? fine_
                                                            : whole_;
  const bool resized = &layers != &whole_;
  fill(slot, panels, decorations, layers, layers.depth);

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
        commands, slot, panels, ground, layers, redraw,
        {.base = resized ? read : copied, .lines = resized ? HiddenLines::kInBase : HiddenLines::kOverCopy});
    if (&layers == &fine_)
      recordReduced(commands, *reduce_, whole_.base);
    else if (resized)
      recordEnlarged(commands, layers, panels, ground);
    recordDecorations(commands, slot, panels, decorations, whole_.base, redraw);
    Barriers compose;
    compose.add(whole_.base.image(), kColour, kColourWritten, copied);
    compose.record(commands);
    if (keepsColours(redraw))
      for (const LivePanel& panel : panels) changed->add(panel.redraw);
    else
      changed.reset();
  }
  Copied copy = copiedTo(target, whole_.base, panels, std::move(changed));
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
  makeRest(submissions, target.extent);
  fill(slot, panels, decorations, fine_, whole_.depth);  // recordTarget() draws the stylus
  const Barriers::Access copied{ImageLayout::eTransferSrcOptimal, Stage::eCopy, Access::eTransferRead};
  if (rest.draws) {
    // The first part may follow a frame that still reduces what was there before.
    const Barriers::Access reduced{ImageLayout::eShaderReadOnlyOptimal, Stage::eFragmentShader,
                                   Access::eShaderRead};
    recordSurface(commands, slot, panels, ground, fine_, rest.first ? Redraw::kFirstPart : Redraw::kParts,
                  {.base = rest.first ? reduced : kColourWritten, .lines = HiddenLines::kOverCopy});
    if (rest.last) {
      recordReduced(commands, *reduce_to_rest_, rest_);
      recordDecorations(commands, slot, panels, decorations, rest_, Redraw::kAll);
      Barriers compose;
      compose.add(rest_.image(), kColour, kColourWritten, copied);
      compose.record(commands);
    }
  }
  Copied copy = copiedTo(target, rest.shows ? rest_ : whole_.base, panels, Places());
  recordTarget(commands, slot, panels, copy, target, Sharpness::kFull);
  return std::move(copy.places);
}

}  // namespace fettle::render
