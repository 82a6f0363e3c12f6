#include "render/page_pool.h"
#include "render/barrier.h"

#include <algorithm>

namespace fettle::render {
namespace {

using Stage = vk::PipelineStageFlagBits2;
using Access = vk::AccessFlagBits2;
using ImageLayout = vk::ImageLayout;
constexpr auto kUsage = vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst;

}  // namespace

PagePool::PagePool(const Context& context, std::uint64_t budget, Marks marks, std::uint32_t max_side)
    : marks_(marks) {
  const vk::ImageFormatProperties limit = context.physical().getImageFormatProperties(
      vk::Format::eR32Uint, vk::ImageType::e2D, vk::ImageTiling::eOptimal, kUsage);
  const std::uint32_t max_layers =
      std::min<std::uint32_t>(context.limits().maxImageArrayLayers, gpu::kEntryLayerMask + 1);
  shape_ = choosePool(budget, hasMarks() ? 5 : 4, max_side, max_layers, limit.maxResourceSize);
  // What the device takes for an image may be more than its samples.
  for (; shape_.layers > 0; --shape_.layers) {
    images_ = {};
    const std::uint32_t side = shape_.across << shape_.log2_side;
    const auto make = [&](vk::Format format) {
      return GpuImage(context, format, {side, side}, shape_.layers, GpuImage::Kind::kArray, kUsage,
                      vk::ImageAspectFlagBits::eColor);
    };
    images_[0] = make(vk::Format::eR32Uint);
    if (hasMarks()) images_[1] = make(vk::Format::eR8Uint);
    bytes_ = images_[0].bytes() + images_[1].bytes();
    if (bytes_ <= budget) break;
  }
  if (shape_.layers == 0) {
    images_ = {};
    bytes_ = 0;
  }
  slots_ = PageSlots(shape_.pages());
}

std::uint32_t PagePool::word(std::uint32_t slot) const noexcept {
  if (slot == PageSlots::kNone) return 1U << gpu::kEntryAwayShift;
  const std::uint32_t a = shape_.across;
  return slot % a | (slot / a % a) << gpu::kEntryUpShift | slot / (a * a) << gpu::kEntryLayerShift;
}

void PagePool::add(TileKind kind, std::uint32_t slot, glm::ivec2 place, glm::ivec2 size,
                   vk::DeviceSize offset) {
  const std::uint32_t a = shape_.across;
  const glm::ivec2 page(static_cast<int>(slot % a), static_cast<int>(slot / a % a));
  const glm::ivec2 at = (page << shape_.log2_side) + place;
  vk::BufferImageCopy copy;
  copy.setBufferOffset(offset)
      .setImageSubresource({vk::ImageAspectFlagBits::eColor, 0, slot / (a * a), 1})
      .setImageOffset({at.x, at.y, 0})
      .setImageExtent({static_cast<std::uint32_t>(size.x), static_cast<std::uint32_t>(size.y), 1});
  copies_[static_cast<std::size_t>(kind)].push_back(copy);
}

void PagePool::flush(const vk::raii::CommandBuffer& commands, const Buffer& staging) {
  if (copies_[0].empty() && copies_[1].empty()) return;
  for (std::size_t kind = 0; kind < (hasMarks() ? 2 : 1); ++kind) {
    const GpuImage& image = images_[kind];
    if (copies_[kind].empty() && prepared_) continue;
    change(commands, image, prepared_ ? ImageLayout::eShaderReadOnlyOptimal : ImageLayout::eUndefined,
           ImageLayout::eTransferDstOptimal, Stage::eAllCommands, Access::eShaderRead, Stage::eCopy,
           Access::eTransferWrite);
    if (!copies_[kind].empty())
      commands.copyBufferToImage(*staging.handle(), image.image(), ImageLayout::eTransferDstOptimal,
                                 copies_[kind]);
    change(commands, image, ImageLayout::eTransferDstOptimal, ImageLayout::eShaderReadOnlyOptimal,
           Stage::eCopy, Access::eTransferWrite, Stage::eAllCommands,
           Access::eShaderRead | Access::eTransferWrite);
    copies_[kind].clear();
  }
  prepared_ = true;
}

}  // namespace fettle::render
