#pragma once

#include <algorithm>
#include <cstdint>

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

}  // namespace fettle::engine
