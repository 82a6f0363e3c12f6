#include "engine/shard/bands.h"

#include <algorithm>

#include "engine/field/tile.h"
#include "engine/filter/catalogue.h"

namespace fettle::engine {

namespace {

std::int64_t tileRowsOf(const Grid& grid) noexcept {
  return (grid.height + kTileSide - 1) / kTileSide;
}

// Of the largest band of so many shards.
std::uint64_t mostMemory(const Grid& grid, const std::optional<FilterSpec>& filter, bool lines, int threads,
                         int count) noexcept {
  // Bands differ by one row of tiles, and those in the middle read more than those at an end: every one is looked at.
  std::uint64_t most = 0;
  for (int k = 1; k <= count; ++k) {
    const RowSpan own = bandOf(grid, {k, count});
    if (own.count > 0)
      most = std::max(most, bandMemory(grid, own, rowsRead(grid, own, filter, lines), filter, threads));
  }
  return most;
}

}  // namespace

RowSpan bandOf(const Grid& grid, const Shard& shard) noexcept {
  const std::int64_t tiles = tileRowsOf(grid);
  const auto rowOf = [&](int number) {
    return static_cast<std::int32_t>(
        std::min<std::int64_t>(tiles * number / shard.count * kTileSide, grid.height));
  };
  const std::int32_t first = rowOf(shard.number - 1);
  return {first, rowOf(shard.number) - first};
}

RowSpan rowsRead(const Grid& grid, const RowSpan& own, const std::optional<FilterSpec>& filter,
                 bool lines) noexcept {
  if (!filter) return own;
  // A reach may be half a million samples: cut in 64 bits.
  const std::int64_t reach = reachOf(*filter, grid, lines), aligned = pieceGridOf(*filter, grid);
  const std::int64_t low = std::max<std::int64_t>(own.first - reach, 0);
  const std::int64_t first = low - low % aligned;
  const std::int64_t end = std::min<std::int64_t>(own.end() + reach, grid.height);
  return {static_cast<std::int32_t>(first), static_cast<std::int32_t>(end - first)};
}

std::uint64_t bandMemory(const Grid& grid, const RowSpan& own, const RowSpan& read,
                         const std::optional<FilterSpec>& filter, int threads) noexcept {
  // The program with its libraries, and rows on their way out.
  constexpr double kProgram = 72e6;
  const double samples = static_cast<double>(grid.width) * read.count;
  double bytes = kProgram + kBandThreadBytes * threads + kFieldBytes * samples;
  if (filter) {
    // What changes is there beside what was, of several passes twice.
    bytes += kFieldBytes * samples * (filter->passes > 1 ? 2.0 : 1.0);
    // Sums at nodes, or heights of the whole band around large bodies.
    if (separatesScales(filterOf(filter->kind))) bytes += 16.0 * samples;
  }
  bytes += 8.0 * static_cast<double>(grid.width) * std::min(own.count, kTileSide);
  return static_cast<std::uint64_t>(bytes);
}

int fewestShards(const Grid& grid, const std::optional<FilterSpec>& filter, bool lines, int threads,
                 std::uint64_t most_bytes) noexcept {
  const auto tiles = static_cast<int>(tileRowsOf(grid));
  if (mostMemory(grid, filter, lines, threads, tiles) > most_bytes) return 0;
  // More shards never take more memory each, but for what a filter's grid adds: the fewest by halving, then one by one.
  int least = 1, enough = tiles;
  while (least < enough) {
    const int middle = least + (enough - least) / 2;
    if (mostMemory(grid, filter, lines, threads, middle) <= most_bytes)
      enough = middle;
    else
      least = middle + 1;
  }
  while (mostMemory(grid, filter, lines, threads, enough) > most_bytes) ++enough;
  return enough;
}

}  // namespace fettle::engine
