#pragma once

#include <cassert>
#include <cstdint>

#include "engine/field/grid.h"
#include "engine/field/tile.h"

namespace fettle::engine {

/// A read-only view of one state of a field. Cheap to copy, owns nothing; valid while the Version it came
/// from exists, or until the next write of the LiveField it came from.
///
/// Heights are returned with the version's sign applied. Threading: any number of readers, on any thread;
/// nothing here allocates, locks or throws.
class FieldReader {
 public:
  FieldReader() = default;
  FieldReader(const Node* root, const Grid* grid, float sign) noexcept
      : root_(root), grid_(grid), sign_(sign) {}

  [[nodiscard]] const Grid& grid() const noexcept { return *grid_; }
  [[nodiscard]] std::int32_t width() const noexcept { return grid_->width; }
  [[nodiscard]] std::int32_t height() const noexcept { return grid_->height; }
  /// +1, or -1 when inverted.
  [[nodiscard]] float sign() const noexcept { return sign_; }
  [[nodiscard]] const Node& root() const noexcept { return *root_; }

  /// Tiles across and up the field.
  [[nodiscard]] std::int32_t tileColumns() const noexcept { return (width() + kTileSide - 1) >> kTileShift; }
  [[nodiscard]] std::int32_t tileRows() const noexcept { return (height() + kTileSide - 1) >> kTileShift; }

  /// The tile in tile column tc, tile row tr; both within the field.
  [[nodiscard]] const Tile& tile(std::int32_t tc, std::int32_t tr) const noexcept {
    assert(tc >= 0 && tr >= 0 && tc < tileColumns() && tr < tileRows());
    const Node* node = root_;
    for (int shift = 3 * (node->level - 2); shift > 0; shift -= 3)
      node = static_cast<const Node*>(node->children[childIndex(tc, tr, shift)]);
    return *static_cast<const Tile*>(node->children[childIndex(tc, tr, 0)]);
  }

  /// What the tree knows of a tile without reading it.
  struct TileEntry {
    const Tile* tile;
    HeightBounds bounds;  ///< of the tile, without the sign
    bool marked, holed;   ///< whether any sample of it is
  };
  /// The same place as tile().
  [[nodiscard]] TileEntry entry(std::int32_t tc, std::int32_t tr) const noexcept {
    assert(tc >= 0 && tr >= 0 && tc < tileColumns() && tr < tileRows());
    const Node* node = root_;
    for (int shift = 3 * (node->level - 2); shift > 0; shift -= 3)
      node = static_cast<const Node*>(node->children[childIndex(tc, tr, shift)]);
    const std::size_t k = childIndex(tc, tr, 0);
    return {static_cast<const Tile*>(node->children[k]),
            {node->child_min[k], node->child_max[k]},
            (node->marked_children >> k & 1) != 0,
            (node->holed_children >> k & 1) != 0};
  }

  /// Height of sample (column, row) [height_unit], sign applied; NaN for a hole. Within the field.
  [[nodiscard]] float heightAt(std::int32_t column, std::int32_t row) const noexcept {
    assert(grid_->contains(column, row));
    const Tile& t = tile(column >> kTileShift, row >> kTileShift);
    return sign_ * t.samples[static_cast<std::size_t>((row & (kTileSide - 1)) * kTileSide +
                                                      (column & (kTileSide - 1)))];
  }

  [[nodiscard]] bool markedAt(std::int32_t column, std::int32_t row) const noexcept {
    assert(grid_->contains(column, row));
    return tile(column >> kTileShift, row >> kTileShift)
        .marked(column & (kTileSide - 1), row & (kTileSide - 1));
  }

  /// Bounds of the SAMPLES in one square of the pyramid: level 0 = 8 x 8 block, 1 = tile, 2 = 512 x 512, ...
  /// (x, y) counts squares of that level from the field's first; sign applied. Empty outside the field.
  /// A cell on a square's right or upper edge also uses samples of the next square: to bound cells, join the
  /// squares (x..x+1, y..y+1).
  [[nodiscard]] HeightBounds bounds(int level, std::int32_t x, std::int32_t y) const noexcept;

  /// Bounds of the whole field, sign applied.
  [[nodiscard]] HeightBounds bounds() const noexcept;

  /// Highest level for which bounds(level, ...) has more than one square: root().level - 1.
  [[nodiscard]] int topLevel() const noexcept { return root_->level - 1; }

  /// Copies the samples [column, column + columns) x [row, row + rows) to out, row-major with stride `stride`
  /// (in elements, >= columns), sign applied. Samples outside the field are returned as NaN.
  void readHeights(std::int32_t column, std::int32_t row, std::int32_t columns, std::int32_t rows, float* out,
                   std::ptrdiff_t stride) const noexcept;

  /// As readHeights for marks: 1 marked, 0 not marked or outside the field.
  void readMarks(std::int32_t column, std::int32_t row, std::int32_t columns, std::int32_t rows,
                 std::uint8_t* out, std::ptrdiff_t stride) const noexcept;

  static constexpr std::size_t childIndex(std::int32_t tc, std::int32_t tr, int shift) noexcept {
    return static_cast<std::size_t>(((tr >> shift) & 7) * 8 + ((tc >> shift) & 7));
  }

 private:
  [[nodiscard]] HeightBounds signedBounds(float lo, float hi) const noexcept {
    return sign_ > 0 ? HeightBounds{lo, hi} : HeightBounds{-hi, -lo};
  }

  const Node* root_ = nullptr;
  const Grid* grid_ = nullptr;
  float sign_ = 1.0F;
};

}  // namespace fettle::engine
