#include "render/residency/page_pool.h"
#include "render/vulkan/barrier.h"

#include <algorithm>
#include <cassert>

namespace fettle::render {
namespace {

constexpr auto kUsage = vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst |
                        vk::ImageUsageFlagBits::eTransferSrc;
constexpr vk::ImageSubresourceLayers layer(int number) {
  return {vk::ImageAspectFlagBits::eColor, 0, static_cast<std::uint32_t>(number), 1};
}

}  // namespace

PagePool::Store PagePool::make(const Context& context, std::uint64_t budget, Marks marks,
                               std::uint32_t max_side, std::optional<int> log2_side) {
  const vk::ImageFormatProperties limit = context.physical().getImageFormatProperties(
      vk::Format::eR32Uint, vk::ImageType::e2D, vk::ImageTiling::eOptimal, kUsage);
  const std::uint32_t max_layers =
      std::min<std::uint32_t>(context.limits().maxImageArrayLayers, gpu::kEntryLayerMask + 1);
  const bool has_marks = marks == Marks::kInclude;
  Store store;
  store.shape = choosePool(budget, has_marks ? 5 : 4, max_side, max_layers, limit.maxResourceSize, log2_side);
  // An image may take more device memory than its samples.
  for (; store.shape.layers > 0; --store.shape.layers) {
    store.images = {};
    const std::uint32_t side = store.shape.across << store.shape.log2_side;
    const auto image = [&](vk::Format format) {
      return GpuImage(context, format, {side, side}, store.shape.layers, GpuImage::Kind::kArray, kUsage,
                      vk::ImageAspectFlagBits::eColor);
    };
    store.images[0] = image(vk::Format::eR32Uint);
    if (has_marks) store.images[1] = image(vk::Format::eR8Uint);
    store.bytes = store.images[0].bytes() + store.images[1].bytes();
    if (store.bytes <= budget) break;
  }
  if (store.shape.layers == 0) {
    store.images = {};
    store.bytes = 0;
  }
  return store;
}

PagePool::PagePool(const Context& context, std::uint64_t budget, Marks marks, std::uint32_t max_side)
    : marks_(marks), store_(make(context, budget, marks, max_side, std::nullopt)) {
  slots_ = PageSlots(store_.shape.pages());
}

glm::ivec3 PagePool::placeOf(const PoolShape& shape, std::uint32_t slot) noexcept {
  const std::uint32_t a = shape.across;
  return {static_cast<int>(slot % a) << shape.log2_side, static_cast<int>(slot / a % a) << shape.log2_side,
          static_cast<int>(slot / (a * a))};
}

void PagePool::grow(const Context& context, std::uint64_t budget, std::uint32_t max_side,
                    Submissions& submissions) {
  assert(copies_[0].empty() && copies_[1].empty());
  submissions.finish();
  Store larger;
  try {
    larger = make(context, budget, marks_, max_side, log2Side());
  } catch (const vk::OutOfDeviceMemoryError&) {
    return;
  } catch (const vk::OutOfHostMemoryError&) {
    return;
  }
  if (larger.shape.pages() <= slots_.count()) return;
  if (prepared_) {
    const vk::Extent3D page{1U << log2Side(), 1U << log2Side(), 1};
    std::vector<vk::ImageCopy> copies;
    for (std::uint32_t slot = 0; slot < slots_.count(); ++slot) {
      if (slots_.holders(slot) == 0) continue;
      const glm::ivec3 from = placeOf(store_.shape, slot), to = placeOf(larger.shape, slot);
      copies.push_back({layer(from.z), {from.x, from.y, 0}, layer(to.z), {to.x, to.y, 0}, page});
    }
    (void)submissions.begin();
    const vk::raii::CommandBuffer& commands = submissions.commands();
    for (std::size_t kind = 0; kind < (hasMarks() ? 2 : 1); ++kind) {
      const GpuImage &from = store_.images[kind], &to = larger.images[kind];
      change(commands, from, ImageLayout::eShaderReadOnlyOptimal, ImageLayout::eTransferSrcOptimal,
             Stage::eAllCommands, Access::eTransferWrite, Stage::eCopy, Access::eTransferRead);
      change(commands, to, ImageLayout::eUndefined, ImageLayout::eTransferDstOptimal, Stage::eAllCommands,
             Access::eNone, Stage::eCopy, Access::eTransferWrite);
      if (!copies.empty())
        commands.copyImage(from.image(), ImageLayout::eTransferSrcOptimal, to.image(),
                           ImageLayout::eTransferDstOptimal, copies);
      change(commands, to, ImageLayout::eTransferDstOptimal, ImageLayout::eShaderReadOnlyOptimal,
             Stage::eCopy, Access::eTransferWrite, Stage::eAllCommands,
             Access::eShaderRead | Access::eTransferWrite);
    }
    submissions.submit({});
    submissions.finish();
  }
  slots_.grow(larger.shape.pages() - slots_.count());
  store_ = std::move(larger);
}

std::uint32_t PagePool::word(std::uint32_t slot) const noexcept {
  if (slot == PageSlots::kNone) return 1U << gpu::kEntryAwayShift;
  const std::uint32_t a = store_.shape.across;
  return slot % a | (slot / a % a) << gpu::kEntryUpShift | slot / (a * a) << gpu::kEntryLayerShift;
}

void PagePool::add(TileKind kind, std::uint32_t slot, glm::ivec2 place, glm::ivec2 size,
                   vk::DeviceSize offset) {
  const glm::ivec3 page = placeOf(store_.shape, slot);
  vk::BufferImageCopy copy;
  copy.setBufferOffset(offset)
      .setImageSubresource(layer(page.z))
      .setImageOffset({page.x + place.x, page.y + place.y, 0})
      .setImageExtent({static_cast<std::uint32_t>(size.x), static_cast<std::uint32_t>(size.y), 1});
  copies_[static_cast<std::size_t>(kind)].push_back(copy);
}

void PagePool::flush(const vk::raii::CommandBuffer& commands, const Buffer& staging) {
  if (copies_[0].empty() && copies_[1].empty()) return;
  for (std::size_t kind = 0; kind < (hasMarks() ? 2 : 1); ++kind) {
    const GpuImage& image = store_.images[kind];
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
