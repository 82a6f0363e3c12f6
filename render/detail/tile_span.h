#pragma once

#include <algorithm>

#include "engine/field/tile.h"

namespace fettle::render {

/// Samples of a tile, last ones included; empty when last < first.
struct TileSpan {
  int first_column = engine::kTileSide, first_row = engine::kTileSide, last_column = -1, last_row = -1;
  [[nodiscard]] bool empty() const noexcept { return last_column < first_column; }
  void join(const TileSpan& other) noexcept {
    first_column = std::min(first_column, other.first_column);
    first_row = std::min(first_row, other.first_row);
    last_column = std::max(last_column, other.last_column);
    last_row = std::max(last_row, other.last_row);
  }
  [[nodiscard]] static constexpr TileSpan whole() noexcept {
    return {0, 0, engine::kTileSide - 1, engine::kTileSide - 1};
  }
};
/// The rectangle in which two states of a tile are not bit-identical.
[[nodiscard]] TileSpan changedHeights(const engine::Tile& a, const engine::Tile& b) noexcept;
[[nodiscard]] TileSpan changedMarks(const engine::Tile& a, const engine::Tile& b) noexcept;

}  // namespace fettle::render
