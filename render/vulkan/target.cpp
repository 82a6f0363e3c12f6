#include "render/vulkan/target.h"
#include "render/vulkan/barrier.h"

namespace fettle::render {
namespace {

using Usage = vk::ImageUsageFlagBits;
using ImageLayout = vk::ImageLayout;
using Stage = vk::PipelineStageFlagBits2;
using Access = vk::AccessFlagBits2;

vk::RenderingAttachmentInfo attachment(const GpuImage& image, ImageLayout layout, vk::ClearValue clear,
                                       Pass pass) {
  vk::RenderingAttachmentInfo info;
  info.setImageView(image.view())
      .setImageLayout(layout)
      .setLoadOp(pass == Pass::kFirst ? vk::AttachmentLoadOp::eClear : vk::AttachmentLoadOp::eLoad)
      .setStoreOp(vk::AttachmentStoreOp::eStore)
      .setClearValue(clear);
  return info;
}

void beginRendering(const vk::raii::CommandBuffer& commands, vk::Extent2D extent,
                    const vk::RenderingAttachmentInfo& colour, const vk::RenderingAttachmentInfo* depth) {
  vk::RenderingInfo info;
  info.setRenderArea({{0, 0}, extent})
      .setLayerCount(1)
      .setColorAttachments(colour)
      .setPDepthAttachment(depth);
  commands.beginRendering(info);
  commands.setViewport(0, vk::Viewport{0.0F, 0.0F, static_cast<float>(extent.width),
                                       static_cast<float>(extent.height), 0.0F, 1.0F});
  commands.setScissor(0, vk::Rect2D{{0, 0}, extent});
}

// Colour ready to be drawn to: the first time its old content, last read as `reader` says, is let go.
void beginColour(const vk::raii::CommandBuffer& commands, const GpuImage& colour, Pass pass,
                 vk::PipelineStageFlags2 reader, vk::AccessFlags2 reading) {
  const bool first = pass == Pass::kFirst;
  change(commands, colour, first ? ImageLayout::eUndefined : ImageLayout::eColorAttachmentOptimal,
         ImageLayout::eColorAttachmentOptimal, first ? reader : Stage::eColorAttachmentOutput,
         first ? reading : Access::eColorAttachmentWrite, Stage::eColorAttachmentOutput,
         Access::eColorAttachmentRead | Access::eColorAttachmentWrite);
}

}  // namespace

SceneTarget::SceneTarget(const Context& context, vk::Extent2D extent)
    : colour(context, kColourFormat, extent, 1, GpuImage::Kind::kPlane,
             Usage::eColorAttachment | Usage::eSampled, vk::ImageAspectFlagBits::eColor),
      depth(context, kDepthFormat, extent, 1, GpuImage::Kind::kPlane, Usage::eDepthStencilAttachment,
            vk::ImageAspectFlagBits::eDepth) {}

void SceneTarget::begin(const vk::raii::CommandBuffer& commands, Pass pass) const {
  beginColour(commands, colour, pass, Stage::eFragmentShader, Access::eShaderRead);
  change(commands, depth,
         pass == Pass::kFirst ? ImageLayout::eUndefined : ImageLayout::eDepthAttachmentOptimal,
         ImageLayout::eDepthAttachmentOptimal, Stage::eEarlyFragmentTests | Stage::eLateFragmentTests,
         Access::eDepthStencilAttachmentWrite, Stage::eEarlyFragmentTests | Stage::eLateFragmentTests,
         Access::eDepthStencilAttachmentRead | Access::eDepthStencilAttachmentWrite);
  const vk::RenderingAttachmentInfo colours = attachment(colour, ImageLayout::eColorAttachmentOptimal,
                                                         vk::ClearColorValue(std::array<float, 4>{}), pass);
  const vk::RenderingAttachmentInfo depths =
      attachment(depth, ImageLayout::eDepthAttachmentOptimal, vk::ClearDepthStencilValue{1.0F, 0}, pass);
  beginRendering(commands, colour.extent(), colours, &depths);
}

void SceneTarget::end(const vk::raii::CommandBuffer& commands) const {
  commands.endRendering();
}

void SceneTarget::finish(const vk::raii::CommandBuffer& commands) const {
  change(commands, colour, ImageLayout::eColorAttachmentOptimal, ImageLayout::eShaderReadOnlyOptimal,
         Stage::eColorAttachmentOutput, Access::eColorAttachmentWrite, Stage::eFragmentShader,
         Access::eShaderRead);
}

PictureTarget::PictureTarget(const Context& context, vk::Extent2D extent)
    : colour(context, kColourFormat, extent, 1, GpuImage::Kind::kPlane,
             Usage::eColorAttachment | Usage::eTransferSrc | Usage::eTransferDst,
             vk::ImageAspectFlagBits::eColor) {}

void PictureTarget::begin(const vk::raii::CommandBuffer& commands, const std::array<float, 3>& ground,
                          Pass pass) const {
  beginColour(commands, colour, pass, Stage::eCopy, Access::eTransferRead);
  const vk::RenderingAttachmentInfo colours =
      attachment(colour, ImageLayout::eColorAttachmentOptimal,
                 vk::ClearColorValue(std::array<float, 4>{ground[0], ground[1], ground[2], 1.0F}), pass);
  beginRendering(commands, colour.extent(), colours, nullptr);
}

void PictureTarget::end(const vk::raii::CommandBuffer& commands) const {
  commands.endRendering();
}

void PictureTarget::finish(const vk::raii::CommandBuffer& commands) const {
  change(commands, colour, ImageLayout::eColorAttachmentOptimal, ImageLayout::eTransferSrcOptimal,
         Stage::eColorAttachmentOutput, Access::eColorAttachmentWrite, Stage::eCopy, Access::eTransferRead);
}

}  // namespace fettle::render
