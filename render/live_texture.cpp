#include "render/live_texture.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "engine/field/difference.h"

namespace fettle::render {
namespace {

constexpr int kSide = engine::kTileSide;
using Stage = vk::PipelineStageFlagBits2;
using Access = vk::AccessFlagBits2;
using ImageLayout = vk::ImageLayout;

std::uint64_t keyOf(std::int32_t column, std::int32_t row) {
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(row)) << 32U |
         static_cast<std::uint32_t>(column);
}
glm::ivec2 tileOf(std::uint64_t key) {
  return {static_cast<std::int32_t>(key & 0xffffffffU), static_cast<std::int32_t>(key >> 32U)};
}

// Marks of the squares of 2^shift samples from `column`, any of them.
std::uint8_t anyMark(const engine::Tile& tile, int column, int row, int shift) {
  const int side = 1 << shift;
  const std::uint64_t mask = (side == kSide ? ~std::uint64_t{0} : (std::uint64_t{1} << side) - 1) << column;
  for (int r = row; r < row + side; ++r)
    if ((tile.marks[static_cast<std::size_t>(r)] & mask) != 0) return 1;
  return 0;
}

}  // namespace

void LiveTexture::Span::join(const Span& other) noexcept {
  first_column = std::min(first_column, other.first_column);
  first_row = std::min(first_row, other.first_row);
  last_column = std::max(last_column, other.last_column);
  last_row = std::max(last_row, other.last_row);
}

LiveTexture::Span LiveTexture::changedHeights(const engine::Tile& a, const engine::Tile& b) noexcept {
  Span span;
  for (int r = 0; r < kSide; ++r) {
    const float* x = a.samples.data() + r * kSide;
    const float* y = b.samples.data() + r * kSide;
    if (std::memcmp(x, y, sizeof(float) * kSide) == 0) continue;
    int first = 0, last = kSide - 1;
    while (std::memcmp(x + first, y + first, sizeof(float)) == 0) ++first;
    while (std::memcmp(x + last, y + last, sizeof(float)) == 0) --last;
    span.join({first, r, last, r});
  }
  return span;
}

LiveTexture::Span LiveTexture::changedMarks(const engine::Tile& a, const engine::Tile& b) noexcept {
  Span span;
  for (int r = 0; r < kSide; ++r) {
    const std::uint64_t d = a.marks[static_cast<std::size_t>(r)] ^ b.marks[static_cast<std::size_t>(r)];
    if (d != 0) span.join({std::countr_zero(d), r, kSide - 1 - std::countl_zero(d), r});
  }
  return span;
}

void LiveTexture::clear() noexcept {
  for (auto& kind : images_)
    for (GpuImage& image : kind) image = GpuImage();
  has_marks_ = false;
  unprepared_[0] = unprepared_[1] = false;
  pending_.clear();
  order_.clear();
  front_ = 0;
  version_ = {};
  ++generation_;
}

void LiveTexture::add(std::int32_t column, std::int32_t row, int kind, const Span& span) {
  if (span.empty()) return;
  const auto [at, fresh] = pending_.try_emplace(keyOf(column, row));
  if (fresh) order_.push_back(at->first);
  at->second.spans[kind].join(span);
}

engine::Result<LiveTexture::Freshness> LiveTexture::want(Context& context, const engine::Version& version,
                                                         MarksOverlay marks, std::uint32_t max_side,
                                                         const std::function<void()>& idle) {
  const engine::Grid& grid = version.grid();
  const engine::FieldReader reader = version.reader();
  const bool related = !version_.empty() && version_.memory() == version.memory() &&
                       version_.grid().width == grid.width && version_.grid().height == grid.height;
  const auto make = [&](int kind, vk::Format format) {
    for (int level = 0; level < kLevels; ++level)
      images_[kind][static_cast<std::size_t>(level)] = GpuImage(
          context, format, {paging_.columns >> shift(level), paging_.rows >> shift(level)}, paging_.layers(),
          GpuImage::Kind::kArray, vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst,
          vk::ImageAspectFlagBits::eColor);
    unprepared_[kind] = true;
    ++generation_;
    for (std::int32_t r = 0; r < reader.tileRows(); ++r)
      for (std::int32_t c = 0; c < reader.tileColumns(); ++c) add(c, r, kind, whole());
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
    make(0, vk::Format::eR32Uint);
  } else if (!(version_ == version)) {
    for (const engine::TileChange& change : engine::changedTiles(version_, version)) {
      add(change.tile_column, change.tile_row, 0, changedHeights(*change.before, *change.after));
      if (has_marks_)
        add(change.tile_column, change.tile_row, 1, changedMarks(*change.before, *change.after));
    }
  }
  if (marks == MarksOverlay::kShow && !has_marks_) {
    if (related) idle();
    make(1, vk::Format::eR8Uint);
    has_marks_ = true;
  }
  version_ = version;
  return related ? Freshness::kRelated : Freshness::kFresh;
}

bool LiveTexture::copy(StagingRing& ring, std::uint64_t submission, glm::ivec2 tile, int kind,
                       const Span& span, std::vector<vk::BufferImageCopy> (&copies)[2][kLevels],
                       UploadStatistics& count) const {
  const engine::Tile& data = version_.reader().tile(tile.x, tile.y);
  const vk::DeviceSize item = kind == 0 ? sizeof(float) : 1;
  // Of each level the samples (or, for marks, the squares) that lie in the span.
  struct Part {
    int column = 0, row = 0, columns = 0, rows = 0;
    vk::DeviceSize offset = 0;
  } parts[kLevels];
  vk::DeviceSize bytes = 0;
  for (int level = 0; level < kLevels; ++level) {
    const int s = shift(level), up = kind == 0 ? (1 << s) - 1 : 0;
    Part& p = parts[level];
    p.column = (span.first_column + up) >> s;
    p.row = (span.first_row + up) >> s;
    p.columns = (span.last_column >> s) - p.column + 1;
    p.rows = (span.last_row >> s) - p.row + 1;
    p.offset = bytes;
    if (p.columns > 0 && p.rows > 0)
      bytes += (static_cast<vk::DeviceSize>(p.columns * p.rows) * item + 15) / 16 * 16;
  }
  const std::optional<vk::DeviceSize> at = ring.take(bytes, submission);
  if (!at) return false;
  for (int level = 0; level < kLevels; ++level) {
    const Part& p = parts[level];
    if (p.columns <= 0 || p.rows <= 0) continue;
    const int s = shift(level);
    std::byte* out = ring.buffer().data() + *at + p.offset;
    for (int r = 0; r < p.rows; ++r) {
      const int row = (p.row + r) << s;
      if (kind == 0) {
        const float* from = data.samples.data() + row * kSide;
        if (level == 0) {
          std::memcpy(out, from + p.column, static_cast<std::size_t>(p.columns) * sizeof(float));
          out += static_cast<std::size_t>(p.columns) * sizeof(float);
        } else {
          for (int c = 0; c < p.columns; ++c, out += sizeof(float))
            std::memcpy(out, from + ((p.column + c) << s), sizeof(float));
        }
      } else {
        for (int c = 0; c < p.columns; ++c) *out++ = std::byte{anyMark(data, (p.column + c) << s, row, s)};
      }
    }
    const std::uint32_t columns = paging_.columns >> s, rows = paging_.rows >> s;
    const std::uint32_t column = static_cast<std::uint32_t>(tile.x * (kSide >> s) + p.column);
    const std::uint32_t row = static_cast<std::uint32_t>(tile.y * (kSide >> s) + p.row);
    vk::BufferImageCopy copy;
    copy.setBufferOffset(*at + p.offset)
        .setImageSubresource(
            {vk::ImageAspectFlagBits::eColor, 0, row / rows * paging_.across + column / columns, 1})
        .setImageOffset(
            {static_cast<std::int32_t>(column % columns), static_cast<std::int32_t>(row % rows), 0})
        .setImageExtent({static_cast<std::uint32_t>(p.columns), static_cast<std::uint32_t>(p.rows), 1});
    copies[kind][level].push_back(copy);
    count.bytes += static_cast<std::int64_t>(static_cast<vk::DeviceSize>(p.columns * p.rows) * item);
  }
  ++count.tiles;
  count.changed_samples += std::int64_t{parts[0].columns} * parts[0].rows;
  return true;
}

bool LiveTexture::pump(StagingRing& ring, std::uint64_t submission, const vk::raii::CommandBuffer& commands,
                       std::int64_t byte_budget, UploadStatistics& count, std::vector<glm::ivec2>& moved) {
  const std::int64_t bytes_before = count.bytes;
  std::vector<vk::BufferImageCopy> copies[2][kLevels];
  while (front_ < order_.size() && count.bytes - bytes_before < byte_budget) {
    const std::uint64_t key = order_[front_];
    Pending& p = pending_.at(key);
    bool room = true;
    for (int kind = 0; kind < 2 && room; ++kind) {
      if (p.spans[kind].empty()) continue;
      room = copy(ring, submission, tileOf(key), kind, p.spans[kind], copies, count);
      if (room && kind == 0) moved.push_back(tileOf(key));
      if (room) p.spans[kind] = Span{};
    }
    if (!room) break;
    pending_.erase(key);
    ++front_;
  }
  if (front_ == order_.size()) {
    order_.clear();
    front_ = 0;
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
