#include "render/residency/tile_copy.h"

#include <cstring>

#include "shaders/layout.h"

namespace fettle::render {
namespace {

// Whether any of the 2^shift x 2^shift samples from `column`, `row` is marked.
bool anyMark(const engine::Tile& tile, int column, int row, int shift) noexcept {
  const int side = 1 << shift;
  const std::uint64_t mask = (side == engine::kTileSide ? ~std::uint64_t{0} : (std::uint64_t{1} << side) - 1)
                             << column;
  for (int r = row; r < row + side; ++r)
    if ((tile.marks[static_cast<std::size_t>(r)] & mask) != 0) return true;
  return false;
}

}  // namespace

TilePart partOf(const TileSpan& span, TileKind kind, int shift) noexcept {
  const int up = kind == TileKind::kHeights ? (1 << shift) - 1 : 0;
  const int column = (span.first_column + up) >> shift, row = (span.first_row + up) >> shift;
  return {column, row, (span.last_column >> shift) - column + 1, (span.last_row >> shift) - row + 1};
}

void copyPart(const engine::Tile& tile, const engine::Tile* accepted, TileKind kind, int shift,
              const TilePart& part, std::byte* out, std::size_t stride) noexcept {
  for (int r = 0; r < part.rows; ++r, out += stride) {
    const int row = (part.row + r) << shift;
    if (kind == TileKind::kMarks) {
      for (int c = 0; c < part.columns; ++c) {
        const int column = (part.column + c) << shift;
        const bool sure = accepted == nullptr || anyMark(*accepted, column, row, shift);
        out[c] = std::byte(!anyMark(tile, column, row, shift) ? 0 : sure ? gpu::kMarked : gpu::kSuggested);
      }
      continue;
    }
    const float* from = tile.samples.data() + row * engine::kTileSide;
    if (shift == 0) {
      std::memcpy(out, from + part.column, static_cast<std::size_t>(part.columns) * sizeof(float));
    } else {
      for (int c = 0; c < part.columns; ++c)
        std::memcpy(out + static_cast<std::size_t>(c) * sizeof(float), from + ((part.column + c) << shift),
                    sizeof(float));
    }
  }
}

}  // namespace fettle::render
