#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/filter/ranks.h"

namespace fettle::engine {

/// A set of samples of a block by their ranks, with counts, so that the k-th smallest is found in some tens of steps
/// whatever the set's size, and a sample enters or leaves in three. Medians as nth_element finds them, but for the sign of
/// a zero: negative zeros are below positive ones.
class RankSet {
 public:
  /// Empty; `ranks` are read until the next begin().
  void begin(const Ranks& ranks);
  void clear() noexcept;

  /// A rank that is not in the set, and no hole's.
  void add(std::uint32_t rank) noexcept { change(rank, 1); }
  /// A rank that is in the set.
  void remove(std::uint32_t rank) noexcept { change(rank, -1); }

  [[nodiscard]] int size() const noexcept { return size_; }
  /// The k-th smallest height, 0 <= k < size().
  [[nodiscard]] float height(int k) const noexcept;
  /// Of an even number the mean of the middle two. Not empty.
  [[nodiscard]] float median() const noexcept;
  /// Median of the distances from median(), which is `median`: by bisection, since the distances grow on both sides of it.
  [[nodiscard]] float spread(float median) const noexcept;
  /// The largest distance from `median`. Not empty.
  [[nodiscard]] float farthest(float median) const noexcept;

 private:
  static constexpr std::uint32_t kGroup = 16;  // words with a count in common

  void change(std::uint32_t rank, int by) noexcept {
    words_[rank / 64] ^= std::uint64_t{1} << (rank % 64);
    in_word_[rank / 64] = static_cast<std::uint8_t>(in_word_[rank / 64] + by);
    in_group_[rank / (64 * kGroup)] = static_cast<std::uint16_t>(in_group_[rank / (64 * kGroup)] + by);
    size_ += by;
  }

  const float* heights_ = nullptr;
  std::vector<std::uint64_t> words_;
  std::vector<std::uint8_t> in_word_;
  std::vector<std::uint16_t> in_group_;
  int size_ = 0;
};

}  // namespace fettle::engine
