#include "render/xr/xr_picture.h"

#include <cstring>

#include "render/vulkan/barrier.h"
#include "render/vulkan/memory.h"
#include "render/xr/hands.h"

namespace fettle::render {
namespace {

// Rows of red, green, blue, opacity in the order of the format's bytes; whether all of it is opaque.
bool fill(const Image& picture, vk::Format format, std::byte* bytes) {
  const bool swapped = format == vk::Format::eB8G8R8A8Srgb;
  bool opaque = true;
  auto* to = reinterpret_cast<std::uint8_t*>(bytes);
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    const std::uint8_t* from = &picture.rgba[i];
    to[i] = from[swapped ? 2 : 0];
    to[i + 1] = from[1];
    to[i + 2] = from[swapped ? 0 : 2];
    to[i + 3] = from[3];
    opaque = opaque && from[3] == 255;
  }
  return opaque;
}

}  // namespace

XrResult XrPicture::set(const XrCalls& calls, XrSession session, Context& context, vk::Format format,
                        const Image& picture) {
  const vk::Extent2D extent{static_cast<std::uint32_t>(picture.width),
                            static_cast<std::uint32_t>(picture.height)};
  if (!images_.made() || images_.extent() != extent) {
    destroy();
    const XrResult made = images_.make(calls, session, context, format, extent, 1);
    if (XR_FAILED(made)) return made;
  }
  XrImages::One image;
  if (const XrResult result = images_.acquire(image); XR_FAILED(result) || result == XR_TIMEOUT_EXPIRED)
    return result;
  const Buffer bytes(context, vk::DeviceSize{4} * extent.width * extent.height,
                     vk::BufferUsageFlagBits::eTransferSrc);
  opaque_ = fill(picture, format, reinterpret_cast<std::byte*>(bytes.data()));
  context.run([&](const vk::raii::CommandBuffer& commands) {
    change(commands, image.image, ImageLayout::eUndefined, ImageLayout::eTransferDstOptimal,
           Stage::eTopOfPipe, {}, Stage::eCopy, Access::eTransferWrite);
    vk::BufferImageCopy copy;
    copy.setImageSubresource({vk::ImageAspectFlagBits::eColor, 0, 0, 1})
        .setImageExtent({extent.width, extent.height, 1});
    commands.copyBufferToImage(*bytes.handle(), image.image, ImageLayout::eTransferDstOptimal, copy);
    change(commands, image.image, ImageLayout::eTransferDstOptimal, ImageLayout::eColorAttachmentOptimal,
           Stage::eCopy, Access::eTransferWrite, Stage::eBottomOfPipe, {});
  });
  const XrResult result = images_.release();
  shown_ = XR_SUCCEEDED(result);
  return result;
}

void XrPicture::destroy() {
  shown_ = false;
  images_.destroy();
}

XrCompositionLayerQuad XrPicture::on(const RoomPanel& panel, XrSpace room) const noexcept {
  auto quad = typed<XrCompositionLayerQuad>(XR_TYPE_COMPOSITION_LAYER_QUAD);
  if (!opaque_)
    quad.layerFlags =
        XR_COMPOSITION_LAYER_BLEND_TEXTURE_SOURCE_ALPHA_BIT | XR_COMPOSITION_LAYER_UNPREMULTIPLIED_ALPHA_BIT;
  quad.space = room;
  quad.eyeVisibility = XR_EYE_VISIBILITY_BOTH;
  quad.subImage = images_.part(0);
  quad.pose = xrPose(panel.pose);
  quad.size = {static_cast<float>(panel.width_m), static_cast<float>(panel.height_m)};
  return quad;
}

}  // namespace fettle::render
