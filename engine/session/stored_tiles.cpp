#include "engine/session/stored_tiles.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <string>

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "engine/field/difference.h"
#include "engine/session/tile_codec.h"

namespace fettle::engine {

namespace {

constexpr std::size_t kTilesRead = 256;

bool fitsGrid(const Tile& tile, const Grid& grid, std::int64_t position) noexcept {
  const std::int64_t tile_columns = (grid.width + kTileSide - 1) / kTileSide;
  const auto columns = std::min<std::int64_t>(kTileSide, grid.width - position % tile_columns * kTileSide);
  const auto rows = std::min<std::int64_t>(kTileSide, grid.height - position / tile_columns * kTileSide);
  bool infinite = false;
  for (const float z : tile.samples) infinite |= std::isinf(z);
  if (infinite) return false;
  if (columns == kTileSide && rows == kTileSide) return true;
  for (std::int64_t r = 0; r < kTileSide; ++r) {
    const std::int64_t first_outside = r < rows ? columns : 0;
    for (std::int64_t c = first_outside; c < kTileSide; ++c)
      if (!std::isnan(tile.samples[static_cast<std::size_t>(r * kTileSide + c)]) ||
          tile.marked(static_cast<int>(c), static_cast<int>(r)))
        return false;
  }
  return true;
}

}  // namespace

Status loadTiles(SessionTables& tables, const Grid& grid, std::span<const TilePlace> places,
                 const std::function<Tile*(std::size_t)>& room, JobControl& job) {
  const std::string& path = tables.database().shownPath();
  const std::int64_t positions =
      std::int64_t{(grid.width + kTileSide - 1) / kTileSide} * ((grid.height + kTileSide - 1) / kTileSide);
  std::vector<std::size_t> order(places.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return places[i].id; });

  std::vector<std::string> packed(std::min(kTilesRead, places.size()));
  tbb::enumerable_thread_specific<TileCodec> codecs;
  for (std::size_t begin = 0; begin < order.size(); begin += kTilesRead) {
    if (job.cancelled()) return cancelled();
    const std::size_t count = std::min(kTilesRead, order.size() - begin);
    for (std::size_t i = 0; i < count; ++i) {
      const TilePlace& place = places[order[begin + i]];
      if (place.position >= positions) return damaged(fmt::format("tile {} is outside", place.id), path);
      if (Status status = tables.readTile(place, packed[i]); !status) return status;
    }
    std::atomic<std::int64_t> bad{0};
    std::atomic<bool> no_memory{false};
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      const TilePlace& place = places[order[begin + i]];
      Tile* tile = room(order[begin + i]);
      // Relaxed: read after the loop has joined.
      if (tile == nullptr)
        no_memory.store(true, std::memory_order_relaxed);
      else if (!codecs.local().decode(packed[i], *tile) || !fitsGrid(*tile, grid, place.position))
        bad.store(place.id, std::memory_order_relaxed);
    });
    if (no_memory.load(std::memory_order_relaxed))
      return failure("memory for its tiles could not be allocated", path);
    if (const std::int64_t id = bad.load(std::memory_order_relaxed); id != 0)
      return damaged(fmt::format("tile {} is not a tile", id), path);
    job.advance(count);
  }
  return {};
}

void finishTile(Tile& tile) noexcept {
  refreshBounds(tile, 0, 0, kTileSide, kTileSide);
  refreshMarks(tile);
  tile.nan_samples = static_cast<std::uint32_t>(
      std::count_if(tile.samples.begin(), tile.samples.end(), [](float v) { return std::isnan(v); }));
}

// Packed at once and then inserted: large enough to use all threads, small enough for memory (2 MB) and to
// cancel soon.
constexpr std::size_t kTilesWritten = 128;
constexpr std::size_t kParallelFrom = 16;

std::vector<TileToStore> allTiles(const Version& version) {
  const FieldReader reader = version.reader();
  std::vector<TileToStore> tiles;
  tiles.reserve(static_cast<std::size_t>(reader.tileColumns()) * reader.tileRows());
  for (std::int32_t tr = 0; tr < reader.tileRows(); ++tr)
    for (std::int32_t tc = 0; tc < reader.tileColumns(); ++tc)
      tiles.push_back({std::int64_t{tr} * reader.tileColumns() + tc, TileRef::share(&reader.tile(tc, tr))});
  return tiles;
}

std::vector<TileToStore> tilesThatDiffer(const Version& before, const Version& after) {
  const std::int64_t columns = before.reader().tileColumns();
  std::vector<TileToStore> tiles;
  for (TileChange& change : changedTiles(before, after))
    if (!sameBits(*change.before, *change.after))
      tiles.push_back({change.tile_row * columns + change.tile_column, std::move(change.after)});
  std::ranges::sort(tiles, {}, &TileToStore::position);
  return tiles;
}

Status storeTiles(SessionTables& tables, const std::vector<TileToStore>& tiles, std::int64_t step,
                  HeadRow& head, std::uint64_t& bytes, JobControl& job) {
  std::vector<std::string> packed(std::min(kTilesWritten, tiles.size()));
  tbb::enumerable_thread_specific<TileCodec> codecs;
  for (std::size_t begin = 0; begin < tiles.size(); begin += kTilesWritten) {
    if (job.cancelled()) return cancelled();
    const std::size_t count = std::min(kTilesWritten, tiles.size() - begin);
    const auto pack = [&](std::size_t i) { codecs.local().encode(*tiles[begin + i].tile, packed[i]); };
    if (count < kParallelFrom)
      for (std::size_t i = 0; i < count; ++i) pack(i);
    else
      tbb::parallel_for(std::size_t{0}, count, pack);
    for (std::size_t i = 0; i < count; ++i) {
      const TilePlace place{tiles[begin + i].position, step, head.next_tile++};
      if (Status status = tables.insertTile(place, packed[i]); !status) return status;
      bytes += packed[i].size();
    }
    job.advance(count);
  }
  return {};
}

}  // namespace fettle::engine
