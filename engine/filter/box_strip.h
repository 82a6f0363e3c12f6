#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/field/reader.h"
#include "engine/simd/cpu.h"

namespace fettle::engine {

/// Means over square windows for a strip of columns, row after row, straight from the tiles: the fast path of
/// makeBoxFilter's filter, with the same bits.
///
/// All samples are taken as integers, multiples of one power of two so small that none loses a bit and so
/// large that no window's sum passes 63 bits. Sums of integers are exact in any order, wrap around on the way
/// and come out right, so that they can run down the columns and along the row as in box.cpp. Where samples
/// have no such power of two rows() says so, and box.cpp's sums of doubles in lanes take over.
///
/// Samples are read as they are stored, without the version's sign: means of negated samples are
/// exactly the negated means.
///
/// Threading: one thread at a time; every thread makes its own.
class BoxStrip {
 public:
  /// Null below AVX-512.
  [[nodiscard]] static std::unique_ptr<BoxStrip> make(int radius, CpuLevel level);

  /// Stands before the outputs [column0, column1) of row `row`, in the field. column0 is a multiple of
  /// kTileSide, column1 too or the field's width. `rows` outputs will be asked for at most. Reads the
  /// window's rows around the first: O(window x columns). Throws std::bad_alloc.
  void begin(const FieldReader& reader, std::int32_t column0, std::int32_t column1, std::int32_t row,
             std::int32_t rows);

  /// The next `rows` rows of outputs, row-major; stride at least column1 - column0 rounded up to kTileSide,
  /// so many are written, unspecified at holes and beyond column1. False when samples do not fit: `out` is
  /// unspecified then, and begin() has to be called before the next rows().
  [[nodiscard]] bool rows(std::int32_t rows, float* out, std::ptrdiff_t stride);

 private:
  explicit BoxStrip(int radius) : radius_(radius) {}

  // Columns of one tile, [offset, offset + columns) of it, multiples of 16; `at` in the sums.
  struct Piece {
    std::int32_t tile_column, offset, columns, at;
  };
  // The samples of all pieces in one row of the field; none when the field has no such row.
  struct Row {
    std::int32_t tile_row = -1;
    std::vector<const float*> tiles;  // of each piece, first sample of the piece's columns in the tile
    [[nodiscard]] bool none() const noexcept { return tile_row < 0; }
  };
  void lookUp(Row& row, std::int32_t y) const;
  [[nodiscard]] bool move(std::int32_t enter, std::int32_t leave);
  void survey(std::int32_t row, std::int32_t rows);

  int radius_;
  FieldReader reader_;
  std::int32_t column0_ = 0, column1_ = 0, next_ = 0;
  std::int32_t first_ = 0;  // sums_[0] stands for this column of the field
  std::vector<Piece> pieces_;
  std::vector<std::int64_t> sums_;         // of the columns of the window
  std::vector<std::int32_t> counts_;       // samples in them, kept only where there are holes
  std::vector<std::int32_t> plain_count_;  // columns in the window of each output, 16 more than outputs
  bool holes_ = false;
  bool started_ = false;
  int exponent_ = 0;  // a sample is an integer times 2^-exponent_
  Row enter_, leave_, ahead_;
};

}  // namespace fettle::engine
