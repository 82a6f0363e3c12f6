#include "render/live/glyph_image.h"

#include <cstring>
#include <optional>

#include "render/vulkan/barrier.h"

namespace fettle::render {

void GlyphImage::upload(const vk::raii::CommandBuffer& commands, StagingRing& staging,
                        std::uint64_t submission, const Glyphs& glyphs) {
  if (generation_ == glyphs.generation()) return;
  constexpr std::uint32_t kSide = Glyphs::kSide;
  const bool first = generation_ == 0;
  if (first)
    image_ = GpuImage(context_, vk::Format::eR8Unorm, {kSide, kSide}, 1, GpuImage::Kind::kPlane,
                      vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst,
                      vk::ImageAspectFlagBits::eColor);
  const std::optional<vk::DeviceSize> at = staging.take(glyphs.image().size(), submission);
  // No room: the glyphs are uploaded with a later frame.
  if (!at && !first) return;
  if (at) std::memcpy(staging.buffer().data() + *at, glyphs.image().data(), glyphs.image().size());
  change(commands, image_, first ? ImageLayout::eUndefined : ImageLayout::eShaderReadOnlyOptimal,
         ImageLayout::eTransferDstOptimal, Stage::eFragmentShader, Access::eShaderRead, Stage::eCopy,
         Access::eTransferWrite);
  if (at) {
    vk::BufferImageCopy copy;
    copy.setBufferOffset(*at)
        .setImageSubresource({vk::ImageAspectFlagBits::eColor, 0, 0, 1})
        .setImageExtent({kSide, kSide, 1});
    commands.copyBufferToImage(*staging.buffer().handle(), image_.image(), ImageLayout::eTransferDstOptimal,
                               copy);
    generation_ = glyphs.generation();
  }
  change(commands, image_, ImageLayout::eTransferDstOptimal, ImageLayout::eShaderReadOnlyOptimal,
         Stage::eCopy, Access::eTransferWrite, Stage::eFragmentShader, Access::eShaderRead);
}

}  // namespace fettle::render
