#pragma once

#include <cstdint>
#include <vector>

#include "engine/filter/block.h"

namespace fettle::engine {

/// The samples of a block in order of height: a median needs no more than the order.
///
/// Every sample has a rank of its own (equal heights are distinguished by their place), so that a set of samples
/// is a set of bits. Holes share the rank `holeRank()`, which lies in a 64-bit word beyond all others.
class Ranks {
 public:
  /// Sorts the samples: a radix sort in three passes of 11 bits, in time proportional to their number.
  void sort(const Block& block);

  /// Rank of sample (column, row) of block.heights at [row * columns + column].
  [[nodiscard]] const std::uint32_t* ranks() const noexcept { return ranks_.data(); }
  /// Height of each rank, ascending.
  [[nodiscard]] const float* heights() const noexcept { return heights_.data(); }
  [[nodiscard]] std::uint32_t holeRank() const noexcept { return hole_rank_; }
  /// Words that a set of bits needs, the holes' word included.
  [[nodiscard]] std::size_t words() const noexcept { return hole_rank_ / 64 + 1; }

 private:
  struct Item {
    std::uint32_t key;  // orders as the heights do
    std::uint32_t place;
  };
  std::vector<Item> items_, swap_;
  std::vector<std::uint32_t> ranks_;
  std::vector<float> heights_;
  std::uint32_t hole_rank_ = 0;
};

}  // namespace fettle::engine
