#include "render/residency/field_texture.h"
#include "render/vulkan/barrier.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include <fmt/format.h>

#include "engine/field/difference.h"

namespace fettle::render {
namespace {

constexpr std::uint32_t kSide = engine::kTileSide;
constexpr vk::DeviceSize kHeightBytes = vk::DeviceSize{engine::kTileSamples} * 4;
constexpr vk::DeviceSize kMarkBytes = engine::kTileSamples;
// Large enough that the cost of a submission does not show, small enough not to double the memory of a field.
constexpr vk::DeviceSize kStagingBytes = vk::DeviceSize{16} << 20;

std::uint32_t wholeTiles(std::uint32_t samples) {
  return (samples + kSide - 1) / kSide * kSide;
}

// Page side along one direction: all of it when that fits, else a power of two.
std::uint32_t pageSide(std::uint32_t samples, std::uint32_t max_side) {
  std::uint32_t side = std::bit_floor(max_side);
  while (side > kSide) {
    const std::uint32_t pages = (samples + side - 1) / side;
    if (pages * side - samples <= samples / 8) break;
    side /= 2;
  }
  return side;
}

void writeMarkBytes(const engine::Tile& tile, std::byte* out) {
  for (int r = 0; r < engine::kTileSide; ++r) {
    const std::uint64_t row = tile.marks[static_cast<std::size_t>(r)];
    for (int c = 0; c < engine::kTileSide; ++c) *out++ = static_cast<std::byte>(row >> c & 1U);
  }
}

}  // namespace

// One tile to bring over, into one of the images.
struct FieldTexture::Piece {
  const engine::Tile* tile;
  std::int32_t column, row;  // of tiles
  bool marks;
};

Paging choosePaging(std::int32_t width, std::int32_t height, std::uint32_t max_side) {
  const auto w = static_cast<std::uint32_t>(width), h = static_cast<std::uint32_t>(height);
  max_side = max_side / kSide * kSide;
  Paging p;
  if (wholeTiles(w) <= max_side && wholeTiles(h) <= max_side) {
    p.columns = wholeTiles(w);
    p.rows = wholeTiles(h);
    return p;
  }
  p.columns = pageSide(w, max_side);
  p.rows = pageSide(h, max_side);
  // The short side of a long strip is one page, which may be larger than the strip by less than a tile's
  // double.
  if (h <= p.rows) p.rows = std::bit_ceil(wholeTiles(h));
  if (w <= p.columns) p.columns = std::bit_ceil(wholeTiles(w));
  p.across = (w + p.columns - 1) / p.columns;
  p.up = (h + p.rows - 1) / p.rows;
  p.log2_columns = std::countr_zero(p.columns);
  p.log2_rows = std::countr_zero(p.rows);
  return p;
}

void FieldTexture::clear() noexcept {
  heights_.reset();
  marks_.reset();
  marks_version_.reset();
  version_ = {};
}

engine::Result<UploadCount> FieldTexture::update(Context& context, const engine::Version& version,
                                                 Marks marks, std::uint32_t max_side,
                                                 engine::JobControl& job) {
  const engine::FieldReader reader = version.reader();
  const engine::Grid& grid = version.grid();
  // Versions that grew apart from different imports share no memory, so a difference says nothing there.
  const bool related = !version_.empty() && version_.memory() == version.memory() &&
                       version_.grid().width == grid.width && version_.grid().height == grid.height;
  if (!related) {
    clear();
    paging_ = choosePaging(grid.width, grid.height, max_side);
    const auto too_large = [&](const std::string& why) {
      return engine::failure(
          fmt::format("a field of {} x {} samples is too large to draw: {}", grid.width, grid.height, why),
          context.name(), "draw a part of it or a field with fewer samples");
    };
    if (paging_.layers() > context.limits().maxImageArrayLayers)
      return too_large(fmt::format("it takes {} image layers, the device has {}", paging_.layers(),
                                   context.limits().maxImageArrayLayers));
    const vk::DeviceSize bytes = vk::DeviceSize{paging_.columns} * paging_.rows * paging_.layers() * 4;
    const vk::ImageFormatProperties limit = context.physical().getImageFormatProperties(
        vk::Format::eR32Uint, vk::ImageType::e2D, vk::ImageTiling::eOptimal,
        vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst);
    if (bytes > limit.maxResourceSize)
      return too_large(fmt::format("it takes {} MiB in one image, the device allows {}", bytes >> 20,
                                   limit.maxResourceSize >> 20));
  }
  const auto image = [&](vk::Format format) {
    return GpuImage(context, format, {paging_.columns, paging_.rows}, paging_.layers(),
                    GpuImage::Kind::kArray,
                    vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst,
                    vk::ImageAspectFlagBits::eColor);
  };
  const auto prepare = [&](const GpuImage& fresh) {
    context.run([&](const vk::raii::CommandBuffer& commands) {
      change(commands, fresh, vk::ImageLayout::eUndefined, vk::ImageLayout::eShaderReadOnlyOptimal,
             vk::PipelineStageFlagBits2::eNone, {}, vk::PipelineStageFlagBits2::eAllCommands,
             vk::AccessFlagBits2::eShaderRead);
    });
  };

  std::vector<Piece> pieces;
  const auto addAll = [&](bool to_marks) {
    for (std::int32_t r = 0; r < reader.tileRows(); ++r)
      for (std::int32_t c = 0; c < reader.tileColumns(); ++c)
        pieces.push_back({&reader.tile(c, r), c, r, to_marks});
  };
  if (!related) {
    heights_.emplace(image(vk::Format::eR32Uint));
    prepare(*heights_);
    addAll(false);
  } else {
    for (const engine::TileChange& change : engine::changedTiles(version_, version)) {
      const engine::Tile& tile = reader.tile(change.tile_column, change.tile_row);
      // A tile that only got marks keeps its heights; comparing 16 KiB costs less than moving them.
      if (std::memcmp(change.before->samples.data(), tile.samples.data(), sizeof(tile.samples)) != 0)
        pieces.push_back({&tile, change.tile_column, change.tile_row, false});
    }
  }
  if (marks == Marks::kBring) {
    if (!marks_) {
      marks_.emplace(image(vk::Format::eR8Uint));
      prepare(*marks_);
      addAll(true);
    } else {
      for (const engine::TileChange& change : engine::changedTiles(*marks_version_, version))
        if (change.before->marks != change.after->marks)
          pieces.push_back(
              {&reader.tile(change.tile_column, change.tile_row), change.tile_column, change.tile_row, true});
    }
  }

  UploadCount count;
  job.begin("uploading", pieces.size());
  if (engine::Status done = upload(context, pieces, count, job); !done) {
    clear();
    return tl::unexpected(done.error());
  }
  version_ = version;
  if (marks == Marks::kBring) marks_version_ = version;
  return count;
}

engine::Status FieldTexture::upload(Context& context, const std::vector<Piece>& pieces, UploadCount& count,
                                    engine::JobControl& job) {
  if (pieces.empty()) return {};
  vk::DeviceSize total = 0;
  for (const Piece& p : pieces) total += p.marks ? kMarkBytes : kHeightBytes;
  const Buffer staging(context, std::min(total, kStagingBytes), vk::BufferUsageFlagBits::eTransferSrc);
  std::size_t next = 0;
  while (next < pieces.size()) {
    if (job.cancelled()) return engine::cancelled();
    std::vector<vk::BufferImageCopy> copies[2];  // heights, marks
    vk::DeviceSize filled = 0;
    const std::size_t first = next;
    for (; next < pieces.size(); ++next) {
      const Piece& p = pieces[next];
      const vk::DeviceSize bytes = p.marks ? kMarkBytes : kHeightBytes;
      if (filled + bytes > staging.bytes()) break;
      if (p.marks)
        writeMarkBytes(*p.tile, staging.data() + filled);
      else
        std::memcpy(staging.data() + filled, p.tile->samples.data(), kHeightBytes);
      const auto column = static_cast<std::uint32_t>(p.column) * kSide,
                 row = static_cast<std::uint32_t>(p.row) * kSide;
      const std::uint32_t layer = row / paging_.rows * paging_.across + column / paging_.columns;
      vk::BufferImageCopy copy;
      copy.setBufferOffset(filled)
          .setImageSubresource({vk::ImageAspectFlagBits::eColor, 0, layer, 1})
          .setImageOffset({static_cast<std::int32_t>(column % paging_.columns),
                           static_cast<std::int32_t>(row % paging_.rows), 0})
          .setImageExtent({kSide, kSide, 1});
      copies[p.marks ? 1 : 0].push_back(copy);
      filled += bytes;
    }
    context.run([&](const vk::raii::CommandBuffer& commands) {
      for (int which = 0; which < 2; ++which) {
        if (copies[which].empty()) continue;
        const GpuImage& image = which == 0 ? *heights_ : *marks_;
        using Stage = vk::PipelineStageFlagBits2;
        using Access = vk::AccessFlagBits2;
        change(commands, image, vk::ImageLayout::eShaderReadOnlyOptimal, vk::ImageLayout::eTransferDstOptimal,
               Stage::eAllCommands, Access::eShaderRead, Stage::eCopy, Access::eTransferWrite);
        commands.copyBufferToImage(*staging.handle(), image.image(), vk::ImageLayout::eTransferDstOptimal,
                                   copies[which]);
        change(commands, image, vk::ImageLayout::eTransferDstOptimal, vk::ImageLayout::eShaderReadOnlyOptimal,
               Stage::eCopy, Access::eTransferWrite, Stage::eAllCommands, Access::eShaderRead);
      }
    });
    count.tiles += static_cast<std::int64_t>(next - first);
    count.bytes += static_cast<std::int64_t>(filled);
    job.advance(next - first);
  }
  return {};
}

}  // namespace fettle::render
