#include "render/live/stylus_pass.h"

#include <algorithm>

#include "render/live/panel_pass.h"

namespace fettle::render {

bool StylusPass::neededBy(std::span<const LivePanel> panels) {
  return std::ranges::any_of(panels, [](const LivePanel& p) { return p.stylus && !empty(p.tested); });
}

void StylusPass::record(const vk::raii::CommandBuffer& commands, std::span<const LivePanel> panels,
                        std::span<const vk::DescriptorSet> sets, const Over& to) {
  const Barriers::Access tested{ImageLayout::eDepthAttachmentOptimal, kDepthStages, kDepthAccess};
  const Barriers::Access read{ImageLayout::eDepthReadOnlyOptimal, kDepthStages | Stage::eFragmentShader,
                              Access::eDepthStencilAttachmentRead | Access::eShaderRead};
  Barriers before;
  before.add(to.depth.image(), kDepth, tested, read);
  before.add(to.image, kColour, kColourWritten, kColourUsed);
  before.record(commands);
  const vk::RenderingAttachmentInfo over =
      attachment(to.colour, ImageLayout::eColorAttachmentOptimal, vk::AttachmentLoadOp::eLoad);
  const vk::RenderingAttachmentInfo against =
      attachment(to.depth.view(), ImageLayout::eDepthReadOnlyOptimal, vk::AttachmentLoadOp::eLoad);
  vk::RenderingInfo rendering;
  rendering.setRenderArea({{0, 0}, to.depth.extent()})
      .setLayerCount(1)
      .setViewMask(view_mask_)
      .setColorAttachments(over)
      .setPDepthAttachment(&against);
  commands.beginRendering(rendering);
  const PanelDraws draws(commands, pipelines_.sceneLayout());
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const LivePanel& p = panels[i];
    if (empty(p.tested) || !p.stylus) continue;
    draws.begin(p, p.tested, to.scale);
    const vk::DescriptorSet set = sets[i];
    if (p.stylus->shadow.x > 0.0F) draws.instances(pipelines_.of(Pipelines::Stylus::kShadow), set, 4, 0, 1);
    const std::size_t bodies = p.stylus->shadow.w > 0.0F ? 2 : 1;
    for (const auto pass : {Pipelines::Stylus::kHidden, Pipelines::Stylus::kSeen})
      draws.instances(pipelines_.of(pass), set, gpu::kStylusVertices, 0, bodies);
  }
  commands.endRendering();
  Barriers after;
  after.add(to.depth.image(), kDepth, read, tested);
  after.add(to.image, kColour, kColourWritten, kColourUsed);
  after.record(commands);
}

}  // namespace fettle::render
