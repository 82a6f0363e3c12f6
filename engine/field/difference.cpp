#include "engine/field/difference.h"

#include <cassert>
#include <cstdint>
#include <cstring>

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
                        same = same && std::memcmp(&a.samples, &b.samples, sizeof(a.samples)) == 0;
                      });
  return same;
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
