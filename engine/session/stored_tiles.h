#pragma once

#include <functional>
#include <span>

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

}  // namespace fettle::engine
