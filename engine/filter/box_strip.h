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
/// Sums run down the columns and along the row, as in box.cpp, and are exact in any order. Where samples have so wide a range
/// that the strip's sums could not be, rows() says so, and box.cpp's sums in lanes take over.
///
/// Samples are read as they are stored, without the version's sign: means of negated samples are
/// exactly the negated means.
///
/// Threading: one thread at a time; every thread makes its own.
class BoxStrip {
 public:
  /// By integers with AVX-512, by doubles with AVX2; null below.
  [[nodiscard]] static std::unique_ptr<BoxStrip> make(int radius, CpuLevel level);
  BoxStrip& operator=(BoxStrip&&) = delete;
  virtual ~BoxStrip() = default;

  /// Stands before the outputs [column0, column1) of row `row`, in the field. column0 is a multiple of
  /// kTileSide, column1 too or the field's width. `rows` outputs will be asked for at most. Reads the
  /// window's rows around the first: O(window x columns). Throws std::bad_alloc.
  void begin(const FieldReader& reader, std::int32_t column0, std::int32_t column1, std::int32_t row,
             std::int32_t rows);

  /// The next `rows` rows of outputs, row-major; stride at least column1 - column0 rounded up to kTileSide,
  /// so many may be written, unspecified at holes and beyond column1. False when samples do not fit: `out` is
  /// unspecified then, and begin() has to be called before the next rows().
  [[nodiscard]] bool rows(std::int32_t rows, float* out, std::ptrdiff_t stride);

 protected:
  /// Columns of one tile: `columns` of them, a multiple of 16, of which the first `inside` lie in the field; `at` in the sums of
  /// columns. What a tile holds beyond the field are holes.
  struct Piece {
    std::int32_t tile_column, offset, columns, inside, at;
  };
  /// A row's samples: those of piece i begin at tiles[i] + at; null: no such row in the field.
  struct Samples {
    const float* const* tiles = nullptr;
    std::ptrdiff_t at = 0;
  };
  /// What is known of all samples that windows of the strip can reach, from the tiles alone.
  struct Survey {
    bool holes = false;
    float largest = 0.0F;  ///< no magnitude is above
    float least = 0.0F;    ///< no magnitude is below; 0 where both signs occur in a tile
  };
  /// The windows of one row of outputs. `at`: where the column that leaves the window at the first output is in the sums; there
  /// are 16 columns and more behind the last window.
  struct Windows {
    std::ptrdiff_t at;
    int count;                 ///< outputs
    int rows;                  ///< of a window that lie in the field
    int full;                  ///< samples that most windows have
    int full_begin, full_end;  ///< outputs whose windows no side of the field cuts, multiples of 16
  };

  explicit BoxStrip(int radius) noexcept : radius_(radius) {}

  /// Begins with sums of no samples, `sums` columns of them. False when samples cannot fit.
  [[nodiscard]] virtual bool clear(const Survey& survey, std::size_t sums) = 0;
  /// Adds a row to the sums of columns and takes one away; either may be none. Whether the samples fit.
  [[nodiscard]] virtual bool move(const Samples& enter, const Samples& leave) = 0;
  /// The means of a row.
  virtual void slide(const Windows& windows, float* out) const = 0;

  [[nodiscard]] int window() const noexcept { return 2 * radius_ + 1; }
  [[nodiscard]] const std::vector<Piece>& pieces() const noexcept { return pieces_; }
  /// Columns in the window of each output that lie in the field, for outputs rounded up to kTileSide.
  [[nodiscard]] const std::int32_t* columnCounts() const noexcept { return column_counts_.data(); }

 private:
  // A row of tiles: of each piece the first sample of its columns.
  struct TileRow {
    std::int32_t number = -1;
    std::vector<const float*> tiles;
  };
  Samples lookUp(TileRow& row, std::int32_t y) const;
  [[nodiscard]] bool moveTo(std::int32_t enter, std::int32_t leave);
  [[nodiscard]] Survey surveyed(std::int32_t row, std::int32_t rows) const;

  int radius_;
  FieldReader reader_;
  std::int32_t column0_ = 0, column1_ = 0, next_ = 0;
  std::int32_t first_ = 0;  // the sums begin with this column of the field
  std::vector<Piece> pieces_;
  std::vector<std::int32_t> column_counts_;
  bool fits_ = false;
  bool started_ = false;
  TileRow enter_, leave_, ahead_;
};

/// The two ways of BoxStrip. All samples as integers, multiples of one power of two so small that none loses a bit and so
/// large that no window's sum passes 63 bits: these wrap around on the way and come out right. Null where the compiler has no AVX-512.
[[nodiscard]] std::unique_ptr<BoxStrip> makeBoxOfIntegers(int radius);
/// Sums in doubles, exact as long as samples are multiples of what their last bit can hold (SumLanes); what samples of some rows have below
/// it is summed by itself as long as a window reaches these rows. Null where the compiler has no AVX2.
[[nodiscard]] std::unique_ptr<BoxStrip> makeBoxOfDoubles(int radius);

}  // namespace fettle::engine
