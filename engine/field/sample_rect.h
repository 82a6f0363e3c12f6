#pragma once

#include <algorithm>
#include <cstdint>

#include "engine/field/grid.h"
#include "engine/field/tile.h"

namespace fettle::engine {

/// Samples [column, column + columns) x [row, row + rows), which may reach beyond a field. Rectangles of tiles
/// are TileRange.
struct SampleRect {
  std::int32_t column = 0, row = 0;
  std::int32_t columns = 0, rows = 0;

  [[nodiscard]] bool empty() const noexcept { return columns <= 0 || rows <= 0; }
  /// The smallest rectangle that holds both.
  [[nodiscard]] SampleRect joined(const SampleRect& other) const noexcept {
    if (empty()) return other;
    if (other.empty()) return *this;
    const std::int32_t left = std::min(column, other.column), low = std::min(row, other.row);
    return {left, low, std::max(column + columns, other.column + other.columns) - left,
            std::max(row + rows, other.row + other.rows) - low};
  }
  friend bool operator==(const SampleRect&, const SampleRect&) = default;
};

/// Tiles [column, column + columns) x [row, row + rows) of a field.
struct TileRange {
  std::int32_t column = 0, row = 0;
  std::int32_t columns = 0, rows = 0;

  [[nodiscard]] bool empty() const noexcept { return columns <= 0 || rows <= 0; }
  [[nodiscard]] std::int64_t tiles() const noexcept { return empty() ? 0 : std::int64_t{columns} * rows; }
  friend bool operator==(const TileRange&, const TileRange&) = default;
};

[[nodiscard]] inline TileRange allTiles(const Grid& grid) noexcept {
  return {0, 0, (grid.width + kTileSide - 1) / kTileSide, (grid.height + kTileSide - 1) / kTileSide};
}

}  // namespace fettle::engine
