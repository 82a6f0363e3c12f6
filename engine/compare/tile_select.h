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

/// The value of rank `rankOf(count)` (0 = smallest, < count) among those that `visit` produces for the
/// field's tiles, exactly and without a copy of them. `visit(rect, take)` calls take(v) for each value of one
/// tile, v >= 0 or NaN (left out); it is called kSelectPasses times per tile, from all workers at the same
/// time, and must produce the same values each time. NaN when there is no value or the job was cancelled:
/// check job.cancelled().
///
/// The bits of doubles >= 0 are ordered as the numbers are, so four passes determine 16 bits each by counting
/// (radix selection; Knuth, The Art of Computer Programming 3, section 5.2.5). Counts are integers: their
/// sum, and so the result, is the same for any number of threads.
[[nodiscard]] Selected selectFromTiles(const FieldReader& field, JobControl& job, const auto& rankOf,
                                       const auto& visit) {
  constexpr int kBits = 64 / kSelectPasses;
  // One table of counts for each strip of tiles, few and large, so that memory stays bounded.
  constexpr std::int64_t kStrips = 16;
  const auto tiles = static_cast<std::int64_t>(tileCount(field));
  Selected selected;
  std::int64_t rank = 0;
  std::uint64_t prefix = 0;
  for (int shift = 64 - kBits; shift >= 0; shift -= kBits) {
    std::vector<std::vector<std::int64_t>> counts(kStrips);
    tbb::parallel_for(std::int64_t{0}, kStrips, [&](std::int64_t strip) {
      std::vector<std::int64_t>& count = counts[static_cast<std::size_t>(strip)];
      count.assign(std::size_t{1} << kBits, 0);
      for (std::int64_t i = tiles * strip / kStrips; i < tiles * (strip + 1) / kStrips; ++i) {
        if (job.cancelled()) return;
        visit(tileRect(field, i), [&](double value) {
          if (std::isnan(value)) return;
          const auto bits = std::bit_cast<std::uint64_t>(value);
          // The bits above the present digit must be the prefix found so far.
          if (shift + kBits < 64 && (bits >> (shift + kBits)) != (prefix >> (shift + kBits))) return;
          ++count[static_cast<std::size_t>((bits >> shift) & ((1U << kBits) - 1))];
        });
        job.advance();
      }
    });
    if (job.cancelled()) return {};
    if (shift + kBits == 64) {
      for (const std::vector<std::int64_t>& count : counts)
        for (const std::int64_t here : count) selected.count += here;
      if (selected.count == 0) return selected;
      rank = rankOf(selected.count);
    }
    for (std::size_t digit = 0; digit < (std::size_t{1} << kBits); ++digit) {
      std::int64_t here = 0;
      for (const std::vector<std::int64_t>& count : counts) here += count[digit];
      if (rank < here) {
        prefix |= static_cast<std::uint64_t>(digit) << shift;
        break;
      }
      rank -= here;
    }
  }
  selected.value = std::bit_cast<double>(prefix);
  return selected;
}

}  // namespace fettle::engine
