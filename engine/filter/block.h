#pragma once

#include <cstddef>

#include "engine/base/job.h"
#include "engine/field/line_cuts.h"
#include "engine/filter/filter.h"
#include "engine/simd/cpu.h"

namespace fettle::engine {

/// One rectangle of outputs and all samples of the field that their windows can reach.
///
///        first_column
///       |<--------->|
///   +---------------------------+
///   |   heights                 |
///   |            +----------+   |
///   |            |   out    |   |
///   |            +----------+   |
///   +---------------------------+
///
/// heights: rows x columns, row-major, NaN = hole. It is cut at the border of the field and nowhere else:
/// where a window leaves it, the window leaves the field. So a kernel needs no knowledge of the field, and a
/// window is the same samples whatever block it is computed in.
struct Block {
  const float* heights = nullptr;
  /// Of heights [elements]; at least 16 more than columns: these may be read and mean nothing.
  std::ptrdiff_t stride = 0;
  int columns = 0;  ///< of heights
  int rows = 0;
  int first_column = 0;  ///< of the outputs, counted in heights
  int first_row = 0;
  int out_columns = 0;
  int out_rows = 0;
  float* out = nullptr;           ///< out_rows x out_columns, row-major; unspecified where heights has a hole
  std::ptrdiff_t out_stride = 0;  ///< out_columns rounded up to 16 or more: these may be written
  /// What the field's edge lines cut, or null for no lines; its places count from the field's first sample,
  /// which is at (-left, -low) in heights.
  const LineCuts* cuts = nullptr;
  std::int32_t left = 0, low = 0;
  bool holes = false;      ///< whether heights holds a NaN; true is legal without
  float magnitude = 0.0F;  ///< no |height| is larger; may be more than the largest

  [[nodiscard]] const float* row(int r) const noexcept { return heights + r * stride; }
};

/// A filter at work on one block after the other, with scratch of its own that follows the block's size.
/// Threading: one thread at a time; every thread makes its own.
class BlockFilter {
 public:
  BlockFilter& operator=(BlockFilter&&) = delete;
  virtual ~BlockFilter() = default;

  /// Fills block.out. False when the job was cancelled, looked at often enough to return within 50 ms. What
  /// each output comes to depends on the samples of its window alone. Throws std::bad_alloc.
  [[nodiscard]] virtual bool run(const Block& block, const JobControl& job) = 0;

  /// Whether an output is the median of its window's samples, of an even number the mean of the middle two: who has
  /// them in order need not run it.
  [[nodiscard]] virtual bool isMedian() const noexcept { return false; }
  /// Whether an output is the exact sum of its window's samples, rounded to double, over their number, rounded to float.
  [[nodiscard]] virtual bool isMean() const noexcept { return false; }
};

}  // namespace fettle::engine
