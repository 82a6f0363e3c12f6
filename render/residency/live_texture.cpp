#include "render/residency/live_texture.h"
#include "render/vulkan/barrier.h"

#include <algorithm>

#include <fmt/format.h>

#include "engine/base/same_bits.h"
#include "engine/field/difference.h"
#include "render/config.h"

namespace fettle::render {
namespace {

std::uint64_t keyOf(std::int32_t column, std::int32_t row) {
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(row)) << 32U |
         static_cast<std::uint32_t>(column);
}
glm::ivec2 tileOf(std::uint64_t key) {
  return {static_cast<std::int32_t>(key & 0xffffffffU), static_cast<std::int32_t>(key >> 32U)};
}

// Where two states of a tile differ in heights: the rectangle, or all of it.
TileSpan changedSpan(const engine::TileChange& change, bool many) {
  if (!many) return changedHeights(*change.before, *change.after);
  return engine::sameBits(change.before->samples, change.after->samples) ? TileSpan{} : TileSpan::whole();
}

}  // namespace

void LiveTexture::clear() noexcept {
  for (auto& kind : images_)
    for (GpuImage& image : kind) image = GpuImage();
  has_marks_ = false;
  unprepared_[0] = unprepared_[1] = false;
  pending_.clear();
  order_.clear();
  priority_.clear();
  front_ = 0;
  version_ = accepted_ = {};
  pages_.reset();
  fixed_left_ = 0;
  ++generation_;
}

void LiveTexture::add(std::int32_t column, std::int32_t row, TileKind kind, const TileSpan& span) {
  if (span.empty()) return;
  const auto [at, fresh] = pending_.try_emplace(keyOf(column, row));
  if (fresh) order_.push_back(at->first);
  at->second.spans[static_cast<std::size_t>(kind)].join(span);
}

void LiveTexture::addChanges(const engine::Version& next, const engine::Version& accepted) {
  // Where suggested marks become accepted ones, no heights change.
  if (!(accepted_ == version_ && accepted == next))
    for (const engine::TileChange& change : engine::changedTiles(accepted_, accepted)) {
      const TileSpan span = changedMarks(*change.before, *change.after);
      if (!has_marks_ || span.empty()) continue;
      add(change.tile_column, change.tile_row, TileKind::kMarks, span);
      if (pages_) pages_->invalidate({change.tile_column, change.tile_row});
    }
  const std::vector<engine::TileChange> changes = engine::changedTiles(version_, next);
  for (const engine::TileChange& change : changes) {
    add(change.tile_column, change.tile_row, TileKind::kHeights,
        changedSpan(change, changes.size() >= kManyTiles));
    if (has_marks_)
      add(change.tile_column, change.tile_row, TileKind::kMarks, changedMarks(*change.before, *change.after));
    // Before the memory of the old tile can be reused.
    if (pages_) pages_->invalidate({change.tile_column, change.tile_row});
  }
}

std::vector<glm::ivec2> LiveTexture::pendingTiles() const {
  std::vector<glm::ivec2> tiles;
  for (const auto& [key, what] : pending_) tiles.push_back(tileOf(key));
  return tiles;
}

bool LiveTexture::anyPending(glm::ivec2 first, glm::ivec2 last) const {
  const auto tiles =
      static_cast<std::size_t>(last.x - first.x + 1) * static_cast<std::size_t>(last.y - first.y + 1);
  if (tiles > pending_.size())
    return std::any_of(pending_.begin(), pending_.end(), [&](const auto& pending) {
      const glm::ivec2 t = tileOf(pending.first);
      return t.x >= first.x && t.y >= first.y && t.x <= last.x && t.y <= last.y;
    });
  for (int y = first.y; y <= last.y; ++y)
    for (int x = first.x; x <= last.x; ++x)
      if (pending_.contains(keyOf(x, y))) return true;
  return false;
}

std::uint64_t LiveTexture::bytesOfWhole(const Context& context, const engine::Grid& grid, MarksOverlay marks,
                                        std::uint32_t max_side) {
  const Paging paging = choosePaging(grid.width, grid.height, max_side);
  const vk::DeviceSize samples = vk::DeviceSize{paging.columns} * paging.rows * paging.layers();
  const vk::ImageFormatProperties limit = context.physical().getImageFormatProperties(
      vk::Format::eR32Uint, vk::ImageType::e2D, vk::ImageTiling::eOptimal,
      vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst);
  if (paging.layers() > context.limits().maxImageArrayLayers || samples * 4 > limit.maxResourceSize) return 0;
  std::uint64_t bytes = 0;
  for (int level = 0; level < kLevels; ++level)
    bytes += (samples >> (2 * shift(level))) * (marks == MarksOverlay::kShow ? 5 : 4);
  return bytes;
}

engine::Result<LiveTexture::Freshness> LiveTexture::setVersion(PagePool& pool, int fixed_from,
                                                               const engine::Version& version,
                                                               const std::function<void()>& idle,
                                                               const engine::Version& accepted) {
  const engine::Grid& grid = version.grid();
  const engine::Version& sure = accepted.empty() ? version : accepted;
  const bool related = pages_ && &pages_->pool() == &pool && !version_.empty() &&
                       version_.memory() == version.memory() && version_.grid().width == grid.width &&
                       version_.grid().height == grid.height;
  if (related) {
    addChanges(version, sure);
    version_ = version;
    accepted_ = sure;
    pages_->setAccepted(sure == version ? engine::Version() : sure);
    return Freshness::kRelated;
  }
  // Not those of a pool: what is uploaded to its pages comes after all frames that are on their way.
  if (!version_.empty() && !pages_) idle();
  clear();
  pages_ = std::make_unique<PageSet>(pool, grid.width, grid.height, fixed_from);
  has_marks_ = pool.hasMarks();
  fixed_left_ = static_cast<std::size_t>(PageSet::fixedPages(pages_->grid(), fixed_from));
  if (!pages_->reserve()) {
    clear();
    return engine::failure(
        fmt::format(
            "the coarse copies of a field of {} x {} samples take more than the {} KiB that a picture may "
            "have on the device",
            grid.width, grid.height, pool.bytes() >> 10U),
        "picture", "allow more memory, or show fewer versions at a time");
  }
  version_ = version;
  accepted_ = sure;
  pages_->setAccepted(sure == version ? engine::Version() : sure);
  ++generation_;
  return Freshness::kFresh;
}

engine::Result<LiveTexture::Freshness> LiveTexture::setVersion(Context& context,
                                                               const engine::Version& version,
                                                               MarksOverlay marks, std::uint32_t max_side,
                                                               const std::function<void()>& idle,
                                                               const engine::Version& accepted) {
  const engine::Grid& grid = version.grid();
  const engine::Version& sure = accepted.empty() ? version : accepted;
  const engine::FieldReader reader = version.reader();
  const bool related = !pages_ && !version_.empty() && version_.memory() == version.memory() &&
                       version_.grid().width == grid.width && version_.grid().height == grid.height;
  const auto make = [&](TileKind what, vk::Format format) {
    const auto kind = static_cast<std::size_t>(what);
    for (int level = 0; level < kLevels; ++level)
      images_[kind][static_cast<std::size_t>(level)] = GpuImage(
          context, format, {paging_.columns >> shift(level), paging_.rows >> shift(level)}, paging_.layers(),
          GpuImage::Kind::kArray, vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst,
          vk::ImageAspectFlagBits::eColor);
    unprepared_[kind] = true;
    ++generation_;
    for (std::int32_t r = 0; r < reader.tileRows(); ++r)
      for (std::int32_t c = 0; c < reader.tileColumns(); ++c) add(c, r, what, TileSpan::whole());
  };
  if (!related) {
    idle();
    clear();
    paging_ = choosePaging(grid.width, grid.height, max_side);
    const vk::DeviceSize bytes = vk::DeviceSize{paging_.columns} * paging_.rows * paging_.layers() * 4;
    const vk::ImageFormatProperties limit = context.physical().getImageFormatProperties(
        vk::Format::eR32Uint, vk::ImageType::e2D, vk::ImageTiling::eOptimal,
        vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst);
    if (paging_.layers() > context.limits().maxImageArrayLayers || bytes > limit.maxResourceSize)
      return engine::failure(
          fmt::format(
              "a field of {} x {} samples is too large to draw: it takes {} MiB in {} image layers, the "
              "device allows {} and {}",
              grid.width, grid.height, bytes >> 20U, paging_.layers(), limit.maxResourceSize >> 20U,
              context.limits().maxImageArrayLayers),
          context.name(), "draw a part of it or a field with fewer samples");
    make(TileKind::kHeights, vk::Format::eR32Uint);
  } else {
    addChanges(version, sure);
  }
  if (marks == MarksOverlay::kShow && !has_marks_) {
    if (related) idle();
    make(TileKind::kMarks, vk::Format::eR8Uint);
    has_marks_ = true;
  }
  version_ = version;
  accepted_ = sure;
  return related ? Freshness::kRelated : Freshness::kFresh;
}

bool LiveTexture::copy(StagingRing& ring, std::uint64_t submission, glm::ivec2 tile, TileKind kind,
                       const TileSpan& span, std::vector<vk::BufferImageCopy> (&copies)[2][kLevels],
                       UploadStatistics& count) const {
  const engine::Tile& data = version_.reader().tile(tile.x, tile.y);
  TilePart parts[kLevels];
  vk::DeviceSize offsets[kLevels] = {}, bytes = 0;
  for (int level = 0; level < kLevels; ++level) {
    parts[level] = partOf(span, kind, shift(level));
    offsets[level] = bytes;
    if (!parts[level].empty()) bytes += (parts[level].items() * bytesOf(kind) + 15) / 16 * 16;
  }
  const std::optional<vk::DeviceSize> at = ring.take(bytes, submission);
  if (!at) return false;
  for (int level = 0; level < kLevels; ++level) {
    const TilePart& p = parts[level];
    if (p.empty()) continue;
    const int s = shift(level);
    copyPart(data, acceptedTile(tile), kind, s, p, ring.buffer().data() + *at + offsets[level],
             static_cast<std::size_t>(p.columns) * bytesOf(kind));
    const std::uint32_t columns = paging_.columns >> s, rows = paging_.rows >> s;
    const std::uint32_t column = static_cast<std::uint32_t>(tile.x * (engine::kTileSide >> s) + p.column);
    const std::uint32_t row = static_cast<std::uint32_t>(tile.y * (engine::kTileSide >> s) + p.row);
    vk::BufferImageCopy copy;
    copy.setBufferOffset(*at + offsets[level])
        .setImageSubresource(
            {vk::ImageAspectFlagBits::eColor, 0, row / rows * paging_.across + column / columns, 1})
        .setImageOffset(
            {static_cast<std::int32_t>(column % columns), static_cast<std::int32_t>(row % rows), 0})
        .setImageExtent({static_cast<std::uint32_t>(p.columns), static_cast<std::uint32_t>(p.rows), 1});
    copies[static_cast<std::size_t>(kind)][level].push_back(copy);
    count.bytes += static_cast<std::int64_t>(p.items() * bytesOf(kind));
  }
  ++count.tiles;
  count.changed_samples += static_cast<std::int64_t>(parts[0].items());
  return true;
}

std::optional<std::uint64_t> LiveTexture::nextPending() {
  while (!priority_.empty() && !pending_.contains(priority_.back())) priority_.pop_back();
  if (!priority_.empty()) return priority_.back();
  while (front_ < order_.size() && !pending_.contains(order_[front_])) ++front_;
  if (front_ < order_.size()) return order_[front_];
  order_.clear();
  front_ = 0;
  return std::nullopt;
}

bool LiveTexture::upToDate(int entry) {
  if (pending_.empty()) return true;
  const PageGrid& grid = pages_->grid();
  const PageGrid::Place place = grid.place(entry);
  const int log2_tiles = grid.log2Side() + shift(place.level) - engine::kTileShift;
  const engine::FieldReader reader = version_.reader();
  const glm::ivec2 first = place.page << log2_tiles;
  const glm::ivec2 end =
      glm::min(first + (1 << log2_tiles), glm::ivec2(reader.tileColumns(), reader.tileRows()));
  bool all = true;
  for (int y = first.y; y < end.y; ++y)
    for (int x = first.x; x < end.x; ++x) {
      const auto found = pending_.find(keyOf(x, y));
      if (found == pending_.end()) continue;
      all = false;
      if (!found->second.has_priority) priority_.push_back(found->first);
      found->second.has_priority = true;
    }
  return all;
}

bool LiveTexture::pumpPages(StagingRing& ring, std::uint64_t submission,
                            const vk::raii::CommandBuffer& commands, const UploadBudget& budget,
                            UploadStatistics& count, std::vector<glm::ivec2>& moved) {
  bool any = false;
  const engine::FieldReader reader = version_.reader();
  for (; fixed_left_ > 0; --fixed_left_) {
    const int entry = pages_->grid().entries() - static_cast<int>(fixed_left_);
    if (pages_->share(entry, reader, submission)) continue;
    std::int64_t bytes = 0;
    if (pages_->load(entry, reader, ring, submission, bytes) != PageSet::Load::kDone) break;
    any = true;
    count.bytes += bytes;
  }
  std::int64_t spent = 0;
  while (spent == 0 || (spent < budget.bytes && !budget.late())) {
    const std::optional<std::uint64_t> key = nextPending();
    if (!key) break;
    const Pending& p = pending_.at(*key);
    std::int64_t bytes = 0;
    if (!pages_->write(tileOf(*key), p.spans, reader, ring, submission, bytes)) break;
    spent += std::max(bytes, kTileCostBytes);
    count.bytes += bytes;
    if (!p.spans[0].empty()) moved.push_back(tileOf(*key));
    for (const TileSpan& span : p.spans) {
      if (span.empty() || bytes == 0) continue;
      ++count.tiles;
      count.changed_samples +=
          std::int64_t{span.last_column - span.first_column + 1} * (span.last_row - span.first_row + 1);
    }
    pending_.erase(*key);
  }
  if (pending_.empty() && fixed_left_ == 0) pages_->name(reader);
  pages_->pool().flush(commands, ring.buffer());
  count.pending_tiles += static_cast<std::int64_t>(pending());
  return any || spent > 0;
}

bool LiveTexture::uploadPending(StagingRing& ring, std::uint64_t submission,
                                const vk::raii::CommandBuffer& commands, const UploadBudget& budget,
                                UploadStatistics& count, std::vector<glm::ivec2>& moved) {
  if (pages_) return pumpPages(ring, submission, commands, budget, count, moved);
  const std::int64_t bytes_before = count.bytes;
  std::vector<vk::BufferImageCopy> copies[2][kLevels];
  while (count.bytes == bytes_before || (count.bytes - bytes_before < budget.bytes && !budget.late())) {
    const std::optional<std::uint64_t> key = nextPending();
    if (!key) break;
    Pending& p = pending_.at(*key);
    bool room = true;
    for (const TileKind kind : {TileKind::kHeights, TileKind::kMarks}) {
      TileSpan& span = p.spans[static_cast<std::size_t>(kind)];
      if (span.empty()) continue;
      room = copy(ring, submission, tileOf(*key), kind, span, copies, count);
      if (!room) break;
      if (kind == TileKind::kHeights) moved.push_back(tileOf(*key));
      span = TileSpan{};
    }
    if (!room) break;
    pending_.erase(*key);
  }
  bool any = false;
  for (int kind = 0; kind < 2; ++kind)
    for (int level = 0; level < kLevels; ++level) {
      if (copies[kind][level].empty() && !unprepared_[kind]) continue;
      const GpuImage& image = images_[kind][static_cast<std::size_t>(level)];
      change(commands, image,
             unprepared_[kind] ? ImageLayout::eUndefined : ImageLayout::eShaderReadOnlyOptimal,
             ImageLayout::eTransferDstOptimal, Stage::eAllCommands, Access::eShaderRead, Stage::eCopy,
             Access::eTransferWrite);
      if (!copies[kind][level].empty())
        commands.copyBufferToImage(*ring.buffer().handle(), image.image(), ImageLayout::eTransferDstOptimal,
                                   copies[kind][level]);
      change(commands, image, ImageLayout::eTransferDstOptimal, ImageLayout::eShaderReadOnlyOptimal,
             Stage::eCopy, Access::eTransferWrite, Stage::eAllCommands,
             Access::eShaderRead | Access::eTransferWrite);
      any = true;
    }
  unprepared_[0] = unprepared_[1] = false;
  count.pending_tiles += static_cast<std::int64_t>(pending_.size());
  return any;
}

}  // namespace fettle::render
