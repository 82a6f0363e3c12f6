#pragma once

#include <cstdint>
#include <vector>

#include "engine/field/version.h"
#include "engine/session/tables.h"

namespace fettle::engine {

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
