#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/job.h"
#include "engine/field/grid.h"
#include "engine/field/sample_rect.h"
#include "engine/filter/filter.h"
#include "engine/simd/cpu.h"

namespace fettle::engine {

/// Values of a rectangle of a field, row-major; rows may be read and written for 16 elements beyond their end.
template <class T>
struct Patch {
  SampleRect rect{};
  std::ptrdiff_t stride = 0;
  std::vector<T> values;

  /// For these samples, with unspecified values. Throws std::bad_alloc.
  void resize(const SampleRect& to) {
    rect = to;
    stride = (to.columns + 31) / 16 * 16;
    values.resize(static_cast<std::size_t>(stride) * static_cast<std::size_t>(to.rows) + 16);
  }
  /// The row of the field with this number, from the rectangle's first column on.
  [[nodiscard]] T* row(std::int32_t r) noexcept { return values.data() + (r - rect.row) * stride; }
  [[nodiscard]] const T* row(std::int32_t r) const noexcept {
    return values.data() + (r - rect.row) * stride;
  }
};

/// A flat element on a grid: the samples within a disk or rectangle around each sample.
struct FlatElement {
  /// `radius_mm` of the disk, or half of the square's side.
  FlatElement(Element element, double radius_mm, const Grid& grid);

  std::int32_t columns = 0, rows = 0;  ///< to each side [samples]
  /// Of a disk: how far it reaches along a row, by the distance of that row, 0 .. rows [samples]. Empty: a rectangle.
  std::vector<std::int32_t> half;
};

/// A ball on a grid: how far below its top its surface lies, by the distance from it.
class BallElement {
 public:
  /// `relief`: no two values of what is eroded differ by more [height_unit]; where the ball lies lower it touches nothing.
  BallElement(double radius_mm, double relief, const Grid& grid);

  [[nodiscard]] std::int32_t columns() const noexcept { return columns_; }  ///< to each side [samples]
  [[nodiscard]] std::int32_t rows() const noexcept { return rows_; }
  /// Of a sample so many columns and rows away, at least 0 [height_unit]; infinite outside the ball. Never less farther
  /// away, rounding included.
  [[nodiscard]] double depthAt(std::int64_t columns, std::int64_t rows) const noexcept;
  /// No depth on a grid of these spacings is larger.
  [[nodiscard]] double deepest() const noexcept { return deepest_; }
  /// Depths of a row from -kMargin - columns() to columns() + kMargin, or null where a table of all rows would be too large.
  [[nodiscard]] const double* tableRow(std::int64_t row) const noexcept;
  static constexpr std::int32_t kMargin = 24;
  /// Of blocks of 8 x 8 samples so many blocks apart, kept for all that the ball reaches: depth at 8 k - 7 samples.
  [[nodiscard]] double depthOfBlocks(std::int32_t columns, std::int32_t rows) const noexcept {
    return blocks_[static_cast<std::size_t>(rows * block_columns_ + columns)];
  }
  [[nodiscard]] std::int32_t blockColumns() const noexcept { return block_columns_ - 1; }
  [[nodiscard]] std::int32_t blockRows() const noexcept { return block_rows_ - 1; }

 private:
  double radius_, squared_, most_, spacing_x_, spacing_y_, height_mm_, deepest_;
  std::int32_t columns_ = 0, rows_ = 0, block_columns_ = 1, block_rows_ = 1;
  std::ptrdiff_t table_stride_ = 0;
  std::vector<double> table_, blocks_;
};

/// What the erosions of one thread take beside their patches.
struct ErosionScratch {
  std::vector<float> line, part;
  std::vector<double> source, least, least_of_many;
};

/// The least of `from` within the element around each sample of to.rect; +infinity where there is no sample. from.rect holds
/// all samples of the field that the element reaches. `parallel`: on all workers of the arena. False when cancelled: then
/// `to` means nothing. Exact: the same for any rectangle and level. Throws std::bad_alloc.
[[nodiscard]] bool erode(const FlatElement& element, const Patch<float>& from, Patch<float>& to,
                         bool parallel, CpuLevel level, ErosionScratch& scratch, const JobControl& job);

/// The least of `from` plus the depth of a ball around each sample of to.rect, where `from` has one; else -infinity. Each
/// sum is rounded once, so that the least of them is the same for any rectangle and level. Otherwise as above.
///
/// Best first: blocks of samples by the least that they can come to, until no other block can come to less.
[[nodiscard]] bool erode(const BallElement& element, const Patch<double>& from, Patch<double>& to,
                         bool parallel, CpuLevel level, ErosionScratch& scratch, const JobControl& job);

}  // namespace fettle::engine
