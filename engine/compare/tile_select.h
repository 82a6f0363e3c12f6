#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <tbb/parallel_for.h>

#include "engine/base/job.h"
#include "engine/compare/tile_sums.h"

namespace fettle::engine {

/// Passes over the field that selectFromTiles makes: it advances the job by kSelectPasses times tileCount.
inline constexpr int kSelectPasses = 4;

struct Selected {
  std::int64_t count = 0;  ///< values that were not NaN
  double value = std::numeric_limits<double>::quiet_NaN();
};

/// Sixteen bits of a value that is looked for, when those above are known.
class SelectDigit {
 public:
  static constexpr int kBits = 64 / kSelectPasses;
  using Counts = std::vector<std::int64_t>;

  SelectDigit(int shift, std::uint64_t prefix) : shift_(shift), prefix_(prefix) {}
  [[nodiscard]] static Counts none() { return Counts(std::size_t{1} << kBits); }
  /// Counts a value >= 0 or NaN (left out) whose bits above these are the prefix found so far.
  void count(double value, Counts& counts) const noexcept {
    if (std::isnan(value)) return;
    const auto bits = std::bit_cast<std::uint64_t>(value);
    if (shift_ + kBits < 64 && (bits >> (shift_ + kBits)) != (prefix_ >> (shift_ + kBits))) return;
    ++counts[static_cast<std::size_t>((bits >> shift_) & ((1U << kBits) - 1))];
  }

 private:
  int shift_;
  std::uint64_t prefix_;
};

/// The value of rank `rankOf(count)` (0 = smallest, < count) among those that `countAll(digit, counts)` counts by
/// SelectDigit::count, exactly and without a copy of them: called kSelectPasses times, it must count the same values each time; false: it
/// was cancelled. NaN when there is no value or it was cancelled.
///
/// The bits of doubles >= 0 are ordered as the numbers are, so four passes determine 16 bits each by counting
/// (radix selection; Knuth, The Art of Computer Programming 3, section 5.2.5). Counts are integers: their
/// sum, and so the result, is the same for any number of threads.
[[nodiscard]] Selected selectByCounting(const auto& rankOf, const auto& countAll) {
  Selected selected;
  std::int64_t rank = 0;
  std::uint64_t prefix = 0;
  for (int shift = 64 - SelectDigit::kBits; shift >= 0; shift -= SelectDigit::kBits) {
    SelectDigit::Counts counts = SelectDigit::none();
    if (!countAll(SelectDigit(shift, prefix), counts)) return {};
    if (shift + SelectDigit::kBits == 64) {
      for (const std::int64_t here : counts) selected.count += here;
      if (selected.count == 0) return selected;
      rank = rankOf(selected.count);
    }
    for (std::size_t digit = 0; digit < counts.size(); ++digit) {
      if (rank < counts[digit]) {
        prefix |= static_cast<std::uint64_t>(digit) << shift;
        break;
      }
      rank -= counts[digit];
    }
  }
  selected.value = std::bit_cast<double>(prefix);
  return selected;
}

/// Counts what `visit` produces for the field's tiles: `visit(rect, take)` calls take(v) for each value of one tile, from all
/// workers at the same time. Advances the job by tileCount. False when cancelled.
[[nodiscard]] bool countTiles(const FieldReader& field, JobControl& job, const SelectDigit& digit,
                              SelectDigit::Counts& counts, const auto& visit) {
  // One table of counts for each strip of tiles, few and large, so that memory stays bounded.
  constexpr std::int64_t kStrips = 16;
  const auto tiles = static_cast<std::int64_t>(tileCount(field));
  std::vector<SelectDigit::Counts> of_strips(kStrips);
  tbb::parallel_for(std::int64_t{0}, kStrips, [&](std::int64_t strip) {
    SelectDigit::Counts& mine = of_strips[static_cast<std::size_t>(strip)];
    mine = SelectDigit::none();
    for (std::int64_t i = tiles * strip / kStrips; i < tiles * (strip + 1) / kStrips; ++i) {
      if (job.cancelled()) return;
      visit(tileRect(field, i), [&](double value) { digit.count(value, mine); });
      job.advance();
    }
  });
  if (job.cancelled()) return false;
  for (const SelectDigit::Counts& strip : of_strips)
    for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += strip[i];
  return true;
}

/// selectByCounting() of the values that `visit` (countTiles) produces for the field's tiles. Check job.cancelled().
[[nodiscard]] Selected selectFromTiles(const FieldReader& field, JobControl& job, const auto& rankOf,
                                       const auto& visit) {
  return selectByCounting(rankOf, [&](const SelectDigit& digit, SelectDigit::Counts& counts) {
    return countTiles(field, job, digit, counts, visit);
  });
}

}  // namespace fettle::engine
