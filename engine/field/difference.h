#pragma once

#include <cstdint>
#include <vector>

#include "engine/field/live_field.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// One tile in which two versions differ. `before` and `after` keep both states alive.
struct TileChange {
  std::int32_t tile_column = 0;
  std::int32_t tile_row = 0;
  TileRef before;
  TileRef after;
};

/// The tiles of which two versions of one grid do not share the very same memory, row-major within each node.
/// Time and memory follow the number of changed tiles, not the size of the field. The sign is not looked at.
[[nodiscard]] std::vector<TileChange> changedTiles(const Version& before, const Version& after);

/// Swaps the tiles of `changes` back to their `before` state (undo) or on to their `after` state (redo), in
/// place. False, with the rest left undone, when a node could not be had (see LiveField).
[[nodiscard]] bool undo(LiveField& field, const std::vector<TileChange>& changes) noexcept;
[[nodiscard]] bool redo(LiveField& field, const std::vector<TileChange>& changes) noexcept;

}  // namespace fettle::engine
