#pragma once

#include <cstdint>
#include <optional>

#include "engine/field/grid.h"
#include "engine/field/row_span.h"
#include "engine/filter/filter.h"

namespace fettle::engine {

/// One of several parts that work is divided into, as people count: 1 .. count.
struct Shard {
  int number = 1, count = 1;

  static constexpr int kMost = 1'000'000;
  friend bool operator==(const Shard&, const Shard&) = default;
};

/// The band of a shard: rows of whole tiles (kTileSide rows, the last one of what is left), as many as those of any other
/// shard or one row of tiles more. Together the bands of all shards are the field, in their order from row 0 on. Empty where
/// there are more shards than rows of tiles.
[[nodiscard]] RowSpan bandOf(const Grid& grid, const Shard& shard) noexcept;

/// The rows that a filter reads to work out `own`, which is not empty: as far around it as the filter's row in the catalogue
/// states, begun where pieces have the field's results (pieceGridOf). `lines`: the field has edge lines. Without a filter
/// `own` itself.
[[nodiscard]] RowSpan rowsRead(const Grid& grid, const RowSpan& own, const std::optional<FilterSpec>& filter,
                               bool lines) noexcept;

/// Of a sample in memory with its share of tiles and their nodes [bytes].
inline constexpr double kFieldBytes = 4.5;
/// That each thread of a shard takes: 8 MB of a reader, and scratch [bytes].
inline constexpr double kBandThreadBytes = 24e6;

/// Memory that a shard with such a band takes at its most, of the whole process [bytes]: meant as an upper
/// bound; a test holds it against a process that filters by a box. `threads` > 0.
[[nodiscard]] std::uint64_t bandMemory(const Grid& grid, const RowSpan& own, const RowSpan& read,
                                       const std::optional<FilterSpec>& filter, int threads) noexcept;

/// The fewest shards of which none takes more than `most_bytes`; 0 where a band of one row of tiles takes more.
[[nodiscard]] int fewestShards(const Grid& grid, const std::optional<FilterSpec>& filter, bool lines,
                               int threads, std::uint64_t most_bytes) noexcept;

}  // namespace fettle::engine
