// Rows of samples across a tile and the two beside it, for the kernels of tile windows; see tile_window.h.
#if FETTLE_LEVEL >= 1

// Of the rows -kReach .. kTileSide - 1 + kReach of a tile: where the last 16 samples of the tile to the left begin, the row's own,
// and the first ones of the tile to the right.
template <int kReach>
class TileRows {
 public:
  explicit TileRows(const TileAround& around) noexcept {
    for (int y = -kReach; y < kTileSide + kReach; ++y) {
      const int band = y < 0 ? 0 : y < kTileSide ? 1 : 2;
      const std::ptrdiff_t at = (y & (kTileSide - 1)) * kTileSide;
      const auto& tiles = around[static_cast<std::size_t>(band)];
      rows_[y + kReach] = {tiles[0] + at + kTileSide, tiles[1] + at, tiles[2] + at};
    }
  }

  // The samples of row y from this column on, a multiple of 4 in -16 .. kTileSide + 12: up to the end of the tile's row,
  // or of 16 columns of the ones beside.
  [[nodiscard]] FETTLE_INLINE const float* at(int y, int column) const noexcept {
    const Row& row = rows_[y + kReach];
    return column < 0           ? row.left_end + column
           : column < kTileSide ? row.own + column
                                : row.right + (column - kTileSide);
  }

 private:
  struct Row {
    const float *left_end, *own, *right;
  };
  Row rows_[kTileSide + 2 * kReach];
};

#endif
