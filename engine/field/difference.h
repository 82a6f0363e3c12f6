#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/field/live_field.h"
#include "engine/field/sample_rect.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// One tile in which two versions differ. `before` and `after` keep both states alive.
struct TileChange {
  std::int32_t tile_column = 0;
  std::int32_t tile_row = 0;
  TileRef before;
  TileRef after;
};

/// The tiles of which two versions of one grid do not share the same memory, row-major within each node. Time
/// and memory are proportional to the number of changed tiles, not to the size of the field. The sign is
/// ignored.
[[nodiscard]] std::vector<TileChange> changedTiles(const Version& before, const Version& after);

/// Whether two versions of one grid have the same heights, bit by bit, whatever their marks, lines and sign. Reads the
/// tiles alone that they do not share.
[[nodiscard]] bool sameHeights(const Version& before, const Version& after);

/// The smallest rectangle of the samples whose heights, bit by bit, or marks differ in two versions of one grid; empty where none
/// does. Nothing where more than `most_tiles` tiles differ: time is proportional to them, some microseconds each.
[[nodiscard]] std::optional<SampleRect> changedSamples(const Version& before, const Version& after,
                                                       std::size_t most_tiles);

/// Swaps the tiles of `changes` to their `before` state (undo) or to their `after` state (redo), in place.
/// False, with the rest unchanged, when a node could not be allocated (see LiveField).
[[nodiscard]] bool undo(LiveField& field, const std::vector<TileChange>& changes) noexcept;
[[nodiscard]] bool redo(LiveField& field, const std::vector<TileChange>& changes) noexcept;

}  // namespace fettle::engine
