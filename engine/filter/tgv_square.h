#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/filter/block.h"
#include "engine/filter/line_sides.h"
#include "engine/filter/tgv_rows.h"

namespace fettle::engine {

/// One square of generalised variation with the samples around it: what its steps start from, and what becomes of
/// their result. The steps themselves are elsewhere (tgv.cpp, tgv_device.h): they change the rows between prepare() and
/// write().
///
/// One object serves one thread at a time; it keeps its memory from one square to the next.
class TgvSquare {
 public:
  /// Heights in units of `noise` [height_unit].
  TgvSquare(double noise, CpuLevel level) : noise_(noise), level_(level) {}

  /// Fills all rows for the first step: heights, with samples that belong to no surface set aside, slopes, and weights
  /// with the links that edge lines cut. Duals are 0. Throws std::bad_alloc.
  void prepare(const Block& block);

  [[nodiscard]] int columns() const noexcept { return columns_; }
  [[nodiscard]] int rows() const noexcept { return rows_; }
  /// Row -1 .. rows(), of which the first and the last are no samples: NaN in f, 0 in the others.
  [[nodiscard]] tgv::Row row(int r) noexcept;

  /// Fills block.out from u; `block` has the heights that were prepared.
  void write(const Block& block);

 private:
  static constexpr int kArrays = 15;
  static constexpr std::ptrdiff_t kPad = 16;  // before a row, and at least after it

  void makeRoom(int columns, int rows);
  void takeHeights(const Block& block);
  void startWeights();
  void setLoneSamplesAside(bool lines);
  void cutLinks();
  void startSlopes(bool lines);
  void findWindowsOverLines(int radius);
  [[nodiscard]] bool isOverLine(int c, int r) const noexcept {
    return over_line_[static_cast<std::size_t>(r * columns_ + c)] != 0;
  }
  void markCentres(int c0, int c1, int r0, int r1);
  void takeSlope(int column, int line, int radius, int least) noexcept;

  double noise_;
  CpuLevel level_;
  double reference_ = 0.0;
  int columns_ = 0, rows_ = 0;
  std::ptrdiff_t stride_ = 0;
  std::vector<float> values_;  // row by row, of each row all arrays
  std::vector<float> middle_;
  std::vector<double> sums_;
  LineSides sides_;
  std::vector<std::uint8_t> over_line_;  // whether the window around a sample reaches over a line
};

}  // namespace fettle::engine
