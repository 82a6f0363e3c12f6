#include "render/live/panel_pass.h"

#include <algorithm>
#include <cmath>

namespace fettle::render {
namespace {

constexpr auto kPanelPoint = vk::PipelineBindPoint::eGraphics;

}  // namespace

vk::Rect2D rectOf(const Rectangle& r) {
  return {
      {r.x, r.y},
      {static_cast<std::uint32_t>(std::max(0, r.width)), static_cast<std::uint32_t>(std::max(0, r.height))}};
}

vk::RenderingAttachmentInfo attachment(vk::ImageView view, ImageLayout layout, vk::AttachmentLoadOp load,
                                       vk::ClearValue clear) {
  vk::RenderingAttachmentInfo info;
  info.setImageView(view)
      .setImageLayout(layout)
      .setLoadOp(load)
      .setStoreOp(vk::AttachmentStoreOp::eStore)
      .setClearValue(clear);
  return info;
}

Rectangle scaled(const Rectangle& r, float scale) {
  if (scale >= 1.0F) {
    const int rays = static_cast<int>(scale);
    return {rays * r.x, rays * r.y, rays * r.width, rays * r.height};
  }
  const int step = static_cast<int>(std::lround(1.0F / scale));
  const int x = r.x / step, y = r.y / step;
  return {x, y, (r.x + r.width + step - 1) / step - x, (r.y + r.height + step - 1) / step - y};
}

// Shaders count pixels of the whole picture, whatever the scale.
void PanelDraws::begin(const LivePanel& panel, const Rectangle& part, float scale) const {
  const vk::Rect2D plot = rectOf(panel.plot);
  commands_.setViewport(
      0, vk::Viewport{scale * static_cast<float>(plot.offset.x), scale * static_cast<float>(plot.offset.y),
                      scale * static_cast<float>(plot.extent.width),
                      scale * static_cast<float>(plot.extent.height), 0.0F, 1.0F});
  commands_.setScissor(0, rectOf(scaled(part, scale)));
  const gpu::vec4 size{plot.extent.width, plot.extent.height, plot.offset.x, plot.offset.y};
  commands_.pushConstants<gpu::vec4>(layout_, vk::ShaderStageFlagBits::eVertex, 0, size);
}

void PanelDraws::instances(vk::Pipeline pipeline, vk::DescriptorSet set, std::uint32_t vertices,
                           std::size_t first, std::size_t count) const {
  commands_.bindPipeline(kPanelPoint, pipeline);
  commands_.bindDescriptorSets(kPanelPoint, layout_, 0, set, {});
  commands_.draw(vertices, static_cast<std::uint32_t>(count), 0, static_cast<std::uint32_t>(first));
}

}  // namespace fettle::render
