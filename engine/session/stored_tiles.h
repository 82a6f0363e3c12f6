#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/field/version.h"
#include "engine/session/tables.h"

namespace fettle::engine {

/// Reads the tiles of `places` (any order; read in the order of their ids, which is that of the file),
/// unpacks them on all worker threads and checks that they are tiles of this grid: no infinity, nothing
/// outside the field. `room(i)` returns the tile to fill for places[i], on any thread; null: memory ran out.
/// Samples and marks are filled, bounds and counts are not. Advances the job by one per tile.
[[nodiscard]] Status loadTiles(SessionTables& tables, const Grid& grid, std::span<const TilePlace> places,
                               const std::function<Tile*(std::size_t)>& room, JobControl& job);

/// Bounds and counts of a tile that was filled.
void finishTile(Tile& tile) noexcept;

/// A tile to be stored at a position (row * columns + column, in tiles).
struct TileToStore {
  std::int64_t position = 0;
  TileRef tile;
};

/// Every tile of a version; those of `after` that differ from `before` in any bit. By position.
[[nodiscard]] std::vector<TileToStore> allTiles(const Version& version);
[[nodiscard]] std::vector<TileToStore> tilesThatDiffer(const Version& before, const Version& after);

/// Packs tiles, on all worker threads when there are many, and inserts them with ids from head.next_tile on,
/// which is advanced; `bytes` counts their size. Advances the job by one per tile; stops when it is
/// cancelled.
[[nodiscard]] Status storeTiles(SessionTables& tables, const std::vector<TileToStore>& tiles,
                                std::int64_t step, HeadRow& head, std::uint64_t& bytes, JobControl& job);

}  // namespace fettle::engine
