#pragma once

#include <cstdint>
#include <vector>

#include "engine/filter/block.h"

namespace fettle::engine {

/// The heights of a block as integers, multiples of one power of two, so that they are added and taken away again without
/// rounding. An object serves one thread; it keeps its buffer.
class WholeHeights {
 public:
  /// Of all samples of `block`, holes as 0. False where some height is no multiple of the power with which sums of `count`
  /// of them, 1 .. 2^20, fit 63 bits: with windows of 51 x 51 of those below 2^-27 of the magnitude. Throws std::bad_alloc.
  [[nodiscard]] bool take(const Block& block, std::int64_t count);

  /// A row of the block, its first column first.
  [[nodiscard]] const std::int64_t* row(int r) const noexcept {
    return heights_.data() + static_cast<std::ptrdiff_t>(r) * columns_;
  }
  /// The mean of `count` heights, > 0, of that sum: the sum rounded to double, over the count, rounded to float.
  [[nodiscard]] float mean(std::int64_t sum, int count) const noexcept;

 private:
  std::vector<std::int64_t> heights_;
  int columns_ = 0, exponent_ = 0;  // heights times 2^exponent
};

}  // namespace fettle::engine
