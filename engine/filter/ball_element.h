#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/field/grid.h"
#include "engine/filter/bowls.h"

namespace fettle::engine {

/// A ball on a grid: how far below its top its surface lies, by the distance from it.
class BallElement {
 public:
  /// All that is eroded lies within lowest .. highest [height_unit]: where the ball lies lower than that it touches nothing.
  BallElement(double radius_mm, double lowest, double highest, const Grid& grid);

  [[nodiscard]] std::int32_t columns() const noexcept { return columns_; }  ///< to each side [samples]
  [[nodiscard]] std::int32_t rows() const noexcept { return rows_; }
  /// Of a sample so many columns and rows away [height_unit]; infinite outside the ball. Never less farther away, rounding
  /// included.
  [[nodiscard]] double depthAt(std::int64_t columns, std::int64_t rows) const noexcept {
    return depthOfBall(depth_, static_cast<double>(columns), static_cast<double>(rows));
  }
  [[nodiscard]] const BallDepth& depth() const noexcept { return depth_; }
  /// No depth on a grid of these spacings is larger.
  [[nodiscard]] double deepest() const noexcept { return deepest_; }
  [[nodiscard]] double lowest() const noexcept { return lowest_; }
  [[nodiscard]] double highest() const noexcept { return highest_; }

  /// Depths by distance, kMargin samples beyond columns() and rows() too: of the sample itself, others tableStride() a row
  /// from it. Null where a table would be too large.
  [[nodiscard]] const double* table() const noexcept {
    return table_.empty() ? nullptr : table_.data() + (rows_ + kMargin) * table_stride_ + columns_ + kMargin;
  }
  [[nodiscard]] std::ptrdiff_t tableStride() const noexcept { return table_stride_; }
  static constexpr std::int32_t kMargin = 40;

  /// Its bowls (bowls.h), and how much they are curved at least along rows and columns [height_unit/sample^2].
  [[nodiscard]] const BowlShape& shape() const noexcept { return shape_; }
  [[nodiscard]] double curvedX() const noexcept { return curved_x_; }
  [[nodiscard]] double curvedY() const noexcept { return curved_y_; }
  /// The square of the slope of a bowl whose sample lies within the ball of all samples of a square block, from its middle.
  [[nodiscard]] float steepest(std::int32_t side) const noexcept;
  /// Of groups of 4 x 4 samples by their distance from 8 x 4 results: depths from below and slopes, 16 each, at the results'
  /// middle. Null where there is no table, or it would not stay in a cache.
  [[nodiscard]] const float* patches() const noexcept {
    return patches_.empty() ? nullptr
                            : patches_.data() + patch_rows_ * patch_stride_ + patch_columns_ * kPatch;
  }
  [[nodiscard]] std::ptrdiff_t patchStride() const noexcept { return patch_stride_; }
  static constexpr std::int32_t kPatch = 48;

 private:
  void makePatches();

  double radius_, lowest_, highest_, deepest_, curved_x_ = 0.0, curved_y_ = 0.0;
  BallDepth depth_;
  BowlShape shape_{};
  std::int32_t columns_ = 0, rows_ = 0, patch_columns_ = 0, patch_rows_ = 0;
  std::ptrdiff_t table_stride_ = 0, patch_stride_ = 0;
  std::vector<double> table_;
  std::vector<float> patches_;
};

}  // namespace fettle::engine
