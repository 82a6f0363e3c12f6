#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "engine/filter/block.h"

namespace fettle::engine {

/// The heights of a block with holes all round, so that kernels read whole windows of whole chunks of outputs without looking for
/// borders. Keeps its memory from block to block. Threading: as BlockFilter.
class PaddedBlock {
 public:
  /// `radius`: how far windows reach [samples]; outputs are worked out `chunk` at a time. Throws std::bad_alloc.
  void fill(const Block& block, int radius, int chunk) {
    radius_ = radius;
    const int outputs = (block.out_columns + chunk - 1) / chunk * chunk;
    stride_ = outputs + 2 * radius;
    const int rows = block.out_rows + 2 * radius;
    heights_.assign(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(rows),
                    std::numeric_limits<float>::quiet_NaN());
    const int column = radius - block.first_column;  // where the block's first goes; >= 0
    const int row = radius - block.first_row;
    for (int r = 0; r < block.rows; ++r)
      std::copy_n(block.row(r), block.columns, heights_.data() + (row + r) * stride_ + column);
  }

  /// At the first output of a row, -radius .. out_rows + radius - 1 [height_unit]; NaN: a hole.
  [[nodiscard]] const float* row(int r) const noexcept {
    return heights_.data() + (r + radius_) * stride_ + radius_;
  }
  [[nodiscard]] std::ptrdiff_t stride() const noexcept { return stride_; }

 private:
  int radius_ = 0;
  std::ptrdiff_t stride_ = 0;
  std::vector<float> heights_;
};

}  // namespace fettle::engine
