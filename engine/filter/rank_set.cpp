#include "engine/filter/rank_set.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/filter/median.h"

namespace fettle::engine {

void RankSet::begin(const Ranks& ranks) {
  heights_ = ranks.heights();
  words_.assign(ranks.words(), 0);
  in_word_.assign(words_.size(), 0);
  in_group_.assign(words_.size() / kGroup + 1, 0);
  size_ = 0;
}

void RankSet::clear() noexcept {
  std::ranges::fill(words_, 0);
  std::ranges::fill(in_word_, std::uint8_t{0});
  std::ranges::fill(in_group_, std::uint16_t{0});
  size_ = 0;
}

float RankSet::height(int k) const noexcept {
  std::size_t group = 0;
  while (k >= in_group_[group]) k -= in_group_[group++];
  std::size_t word = group * kGroup;
  while (k >= in_word_[word]) k -= in_word_[word++];
  std::uint64_t bits = words_[word];
  for (; k > 0; --k) bits &= bits - 1;
  return heights_[word * 64 + static_cast<std::size_t>(std::countr_zero(bits))];
}

float RankSet::median() const noexcept {
  const float middle = height(size_ / 2);
  return size_ % 2 != 0 ? middle : midpoint(height(size_ / 2 - 1), middle);
}

float RankSet::spread(float median) const noexcept {
  // Of the heights in order those before `left` are no larger than the median, the others no smaller.
  const int left = size_ / 2, right = size_ - left, k = size_ / 2;
  const auto below = [&](int i) { return std::fabs(height(left - 1 - i) - median); };
  const auto above = [&](int i) { return std::fabs(height(left + i) - median); };
  // How many of the k smallest distances are below: the fewest whose next is no smaller than the last of those above.
  int from = std::max(0, k - right), to = std::min(k, left);
  while (from < to) {
    const int i = from + (to - from) / 2;
    if (below(i) < above(k - i - 1))
      from = i + 1;
    else
      to = i;
  }
  const int i = from, j = k - from;
  const float next = i == left ? above(j) : j == right ? below(i) : std::min(below(i), above(j));
  if (size_ % 2 != 0) return next;
  const float last = i == 0 ? above(j - 1) : j == 0 ? below(i - 1) : std::max(below(i - 1), above(j - 1));
  return midpoint(last, next);
}

float RankSet::farthest(float median) const noexcept {
  return std::max(std::fabs(height(0) - median), std::fabs(height(size_ - 1) - median));
}

}  // namespace fettle::engine
