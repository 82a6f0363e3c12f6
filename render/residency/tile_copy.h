#pragma once

#include <cstddef>

#include "engine/field/tile.h"
#include "render/detail/tile_span.h"

namespace fettle::render {

/// The two kinds of data of a tile on the device: floats, and one byte per mark.
enum class TileKind { kHeights = 0, kMarks = 1 };
[[nodiscard]] constexpr std::size_t bytesOf(TileKind kind) noexcept {
  return kind == TileKind::kHeights ? sizeof(float) : 1;
}

/// Part of a tile at one level of the device's copies.
struct TilePart {
  int column = 0, row = 0, columns = 0, rows = 0;
  [[nodiscard]] bool empty() const noexcept { return columns <= 0 || rows <= 0; }
  [[nodiscard]] std::size_t items() const noexcept {
    return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  }
};
/// Of the level of every 2^shift-th sample, those in the span; of marks, those whose square of samples meets
/// it (a coarse mark is set when any sample of its square is marked). 0 <= shift <= 6.
[[nodiscard]] TilePart partOf(const TileSpan& span, TileKind kind, int shift) noexcept;
/// Writes a part to `out`, row by row, `stride` bytes from one row to the next. Of marks: gpu::kMarked, and
/// gpu::kSuggested for those that `accepted` lacks; null: it lacks none.
void copyPart(const engine::Tile& tile, const engine::Tile* accepted, TileKind kind, int shift,
              const TilePart& part, std::byte* out, std::size_t stride) noexcept;

}  // namespace fettle::render
