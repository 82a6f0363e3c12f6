#include "engine/session/step_tiles.h"

#include <algorithm>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "engine/field/difference.h"
#include "engine/session/tile_codec.h"

namespace fettle::engine {

namespace {

// Packed at once and then inserted: large enough to use all threads, small enough for memory (2 MB) and to
// cancel soon.
constexpr std::size_t kTilesWritten = 128;
constexpr std::size_t kParallelFrom = 16;

}  // namespace

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
