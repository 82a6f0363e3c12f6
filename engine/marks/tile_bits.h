#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/field/grid.h"
#include "engine/field/sample_rect.h"
#include "engine/marks/change_marks.h"

namespace fettle::engine {

/// One bit per sample, by tiles.
class TileBits {
 public:
  explicit TileBits(const Grid& grid) : range_(allTiles(grid)), width_(grid.width), height_(grid.height) {
    rows_.resize(static_cast<std::size_t>(range_.columns) * static_cast<std::size_t>(range_.rows));
  }
  [[nodiscard]] bool has(std::int32_t c, std::int32_t r) const noexcept {
    if (c < 0 || r < 0 || c >= width_ || r >= height_) return false;
    return ((word(c, r) >> (c & (kTileSide - 1))) & 1U) != 0;
  }
  void set(std::int32_t c, std::int32_t r) noexcept { word(c, r) |= bit(c); }
  void clear(std::int32_t c, std::int32_t r) noexcept { word(c, r) &= ~bit(c); }
  // Samples of one row, clipped to the field.
  void setSpan(std::int32_t c0, std::int32_t c1, std::int32_t r) noexcept {
    if (r < 0 || r >= height_) return;
    for (std::int32_t c = std::max(c0, 0); c < std::min(c1, width_); ++c) set(c, r);
  }
  [[nodiscard]] const MarkRows& tile(std::int32_t tc, std::int32_t tr) const noexcept {
    return rows_[static_cast<std::size_t>(tr) * static_cast<std::size_t>(range_.columns) +
                 static_cast<std::size_t>(tc)];
  }

 private:
  static std::uint64_t bit(std::int32_t c) noexcept { return std::uint64_t{1} << (c & (kTileSide - 1)); }
  [[nodiscard]] const std::uint64_t& word(std::int32_t c, std::int32_t r) const noexcept {
    return tile(c >> kTileShift, r >> kTileShift)[static_cast<std::size_t>(r & (kTileSide - 1))];
  }
  [[nodiscard]] std::uint64_t& word(std::int32_t c, std::int32_t r) noexcept {
    return const_cast<std::uint64_t&>(std::as_const(*this).word(c, r));
  }

  TileRange range_;
  std::int32_t width_, height_;
  std::vector<MarkRows> rows_;
};

}  // namespace fettle::engine
