#include "engine/filter/ranks.h"

#include <array>
#include <bit>

namespace fettle::engine {

namespace {

// Unsigned integers that order as the floats do: positive ones above negative ones, those turned around.
std::uint32_t keyOf(float height) noexcept {
  const auto bits = std::bit_cast<std::uint32_t>(height);
  return bits ^ ((bits >> 31) != 0 ? 0xffffffffU : 0x80000000U);
}

float heightOf(std::uint32_t key) noexcept {
  return std::bit_cast<float>(key ^ ((key >> 31) != 0 ? 0x80000000U : 0xffffffffU));
}

}  // namespace

void Ranks::sort(const Block& block) {
  constexpr int kBits = 11;
  constexpr std::uint32_t kMask = (1U << kBits) - 1;
  std::array<std::array<std::uint32_t, kMask + 1>, 3> starts{};

  const std::size_t all = static_cast<std::size_t>(block.columns) * static_cast<std::size_t>(block.rows);
  items_.resize(all);
  std::size_t n = 0;
  std::uint32_t place = 0;
  for (int r = 0; r < block.rows; ++r)
    for (int c = 0; c < block.columns; ++c, ++place) {
      const float v = block.row(r)[c];
      if (v != v) continue;
      const std::uint32_t key = keyOf(v);
      items_[n++] = {key, place};
      for (std::size_t p = 0; p < 3; ++p) ++starts[p][(key >> (kBits * p)) & kMask];
    }
  swap_.resize(n);
  for (std::size_t p = 0; p < 3; ++p) {
    std::uint32_t at = 0;
    bool one_digit = false;
    for (std::uint32_t& start : starts[p]) {
      one_digit |= start == n;
      const std::uint32_t count = start;
      start = at;
      at += count;
    }
    if (one_digit) continue;  // all samples agree here: sign and exponent often do
    for (std::size_t i = 0; i < n; ++i)
      swap_[starts[p][(items_[i].key >> (kBits * p)) & kMask]++] = items_[i];
    items_.swap(swap_);
    swap_.resize(n);
  }

  hole_rank_ = static_cast<std::uint32_t>((n + 63) / 64 * 64);
  ranks_.assign(all, hole_rank_);
  heights_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    ranks_[items_[i].place] = static_cast<std::uint32_t>(i);
    heights_[i] = heightOf(items_[i].key);
  }
}

}  // namespace fettle::engine
