#include "engine/field/difference.h"

#include <bit>
#include <cassert>
#include <cstdint>

#include "engine/base/same_bits.h"
#include "engine/field/difference_inl.h"

namespace fettle::engine {

std::vector<TileChange> changedTiles(const Version& before, const Version& after) {
  assert(before.grid().width == after.grid().width && before.grid().height == after.grid().height);
  std::vector<TileChange> changes;
  detail::walkChanges(before.reader().root(), after.reader().root(), 0, 0,
                      [&](std::int32_t column, std::int32_t row, const Tile& a, const Tile& b) {
                        changes.push_back({column, row, TileRef::share(&a), TileRef::share(&b)});
                      });
  return changes;
}

bool sameHeights(const Version& before, const Version& after) {
  assert(before.grid().width == after.grid().width && before.grid().height == after.grid().height);
  bool same = true;
  detail::walkChanges(before.reader().root(), after.reader().root(), 0, 0,
                      [&](std::int32_t, std::int32_t, const Tile& a, const Tile& b) {
                        same = same && sameBits(a.samples, b.samples);
                      });
  return same;
}

std::optional<SampleRect> changedSamples(const Version& before, const Version& after,
                                         std::size_t most_tiles) {
  const std::vector<TileChange> changes = changedTiles(before, after);
  if (changes.size() > most_tiles) return std::nullopt;
  SampleRect changed;
  for (const TileChange& change : changes)
    for (std::int32_t r = 0; r < kTileSide; ++r) {
      const float* const a = &change.before->samples[static_cast<std::size_t>(r) * kTileSide];
      const float* const b = &change.after->samples[static_cast<std::size_t>(r) * kTileSide];
      std::uint64_t differ = change.before->marks[static_cast<std::size_t>(r)] ^
                             change.after->marks[static_cast<std::size_t>(r)];
      for (std::int32_t c = 0; c < kTileSide; ++c)
        differ |= std::uint64_t{std::bit_cast<std::uint32_t>(a[c]) != std::bit_cast<std::uint32_t>(b[c])}
                  << c;
      if (differ == 0) continue;
      const std::int32_t first = std::countr_zero(differ), last = kTileSide - 1 - std::countl_zero(differ);
      changed = changed.joined(
          {change.tile_column * kTileSide + first, change.tile_row * kTileSide + r, last - first + 1, 1});
    }
  return changed;
}

bool undo(LiveField& field, const std::vector<TileChange>& changes) noexcept {
  for (const TileChange& change : changes)
    if (!field.replaceTile(change.tile_column, change.tile_row, change.before)) return false;
  return true;
}

bool redo(LiveField& field, const std::vector<TileChange>& changes) noexcept {
  for (const TileChange& change : changes)
    if (!field.replaceTile(change.tile_column, change.tile_row, change.after)) return false;
  return true;
}

}  // namespace fettle::engine
