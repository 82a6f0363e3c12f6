#include "engine/suggest/mosaic.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "engine/field/builder.h"

namespace fettle::engine {

namespace {

constexpr int kPiecesASide = 5;
constexpr double kRelief = 12.0;  // [noises]; what a tile of noise alone has is 8 to 9

struct Place {
  std::int32_t column, row;  // of a tile
};

// The piece around a tile of [from, to) of tiles: of those with an edge, or at least some relief, the one with the
// middle range of heights, so that high and low edges are there as they are in the scan; else the one with the largest.
SampleRect pieceIn(const FieldReader& field, double relief, std::int32_t tc0, std::int32_t tc1,
                   std::int32_t tr0, std::int32_t tr1) {
  std::vector<std::pair<double, Place>> tiles;
  for (std::int32_t tr = tr0; tr < tr1; ++tr)
    for (std::int32_t tc = tc0; tc < tc1; ++tc) {
      const HeightBounds& b = field.tile(tc, tr).bounds;
      const double range = b.empty() ? -1.0 : static_cast<double>(b.max) - static_cast<double>(b.min);
      tiles.push_back({range, {tc, tr}});
    }
  std::ranges::stable_sort(tiles, {}, &std::pair<double, Place>::first);
  const auto with = std::ranges::find_if(tiles, [relief](const auto& tile) { return tile.first > relief; });
  const auto chosen = with == tiles.end() ? tiles.end() - 1 : with + (tiles.end() - with) / 2;
  const std::int32_t column = chosen->second.column, row = chosen->second.row;
  SampleRect rect;
  rect.columns = std::min(kMosaicSide, field.width());
  rect.rows = std::min(kMosaicSide, field.height());
  const auto about = [](std::int32_t tile, std::int32_t side, std::int32_t all) {
    return std::clamp(tile * kTileSide + (kTileSide - side) / 2, 0, all - side);
  };
  rect.column = about(column, rect.columns, field.width());
  rect.row = about(row, rect.rows, field.height());
  return rect;
}

Mosaic::Piece placed(const Grid& grid, const SampleRect& from, std::int32_t column, std::int32_t row) {
  const auto margin = [](bool cut) { return cut ? kMosaicMargin : 0; };
  const std::int32_t left = margin(from.column > 0), low = margin(from.row > 0);
  const std::int32_t right = margin(from.column + from.columns < grid.width);
  const std::int32_t top = margin(from.row + from.rows < grid.height);
  return {from, column, row, {column + left, row + low, from.columns - left - right, from.rows - low - top}};
}

int piecesAlong(std::int32_t side) {
  return std::clamp((side + kMosaicSide - 1) / kMosaicSide, 1, kPiecesASide);
}

}  // namespace

Mosaic makeMosaic(const Version& field, double sigma) {
  if (field.grid().samples() <= kMosaicWhole) {
    const SampleRect whole{0, 0, field.grid().width, field.grid().height};
    return {field, {{whole, 0, 0, whole}}};
  }
  const double relief = kRelief * sigma;
  constexpr std::int32_t kPitch = kMosaicSide + kMosaicGap;
  const FieldReader reader = field.reader();
  const int across = piecesAlong(reader.width()), up = piecesAlong(reader.height());
  Mosaic mosaic;
  for (int y = 0; y < up; ++y)
    for (int x = 0; x < across; ++x)
      mosaic.pieces.push_back(
          placed(reader.grid(),
                 pieceIn(reader, relief, reader.tileColumns() * x / across,
                         std::max(reader.tileColumns() * (x + 1) / across, 1), reader.tileRows() * y / up,
                         std::max(reader.tileRows() * (y + 1) / up, 1)),
                 x * kPitch, y * kPitch));
  const Mosaic::Piece& last = mosaic.pieces.back();
  Grid grid = field.grid();
  grid.width = last.column + last.from.columns;
  grid.height = last.row + last.from.rows;
  std::vector<float> heights(static_cast<std::size_t>(grid.samples()), std::nanf(""));
  std::vector<std::uint8_t> marks(heights.size());
  for (const Mosaic::Piece& p : mosaic.pieces) {
    const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(p.row) * grid.width + p.column;
    reader.readHeights(p.from.column, p.from.row, p.from.columns, p.from.rows, heights.data() + at,
                       grid.width);
    reader.readMarks(p.from.column, p.from.row, p.from.columns, p.from.rows, marks.data() + at, grid.width);
  }
  mosaic.field = makeField(grid, heights, marks);
  return mosaic;
}

}  // namespace fettle::engine
