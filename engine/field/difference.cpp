#include "engine/field/difference.h"

#include <cassert>

namespace fettle::engine {

namespace {

void descend(const Node& before, const Node& after, std::int32_t tc, std::int32_t tr,
             std::vector<TileChange>& out) {
  if (&before == &after) return;
  const std::int32_t tiles_a_child = 1 << (3 * (before.level - 2));
  for (int k = 0; k < kFanOut; ++k) {
    const void* a = before.children[k];
    const void* b = after.children[k];
    if (a == b) continue;
    const std::int32_t column = tc + (k % 8) * tiles_a_child;
    const std::int32_t row = tr + (k / 8) * tiles_a_child;
    if (before.level == 2)
      out.push_back({column, row, TileRef::share(static_cast<const Tile*>(a)),
                     TileRef::share(static_cast<const Tile*>(b))});
    else
      descend(*static_cast<const Node*>(a), *static_cast<const Node*>(b), column, row, out);
  }
}

}  // namespace

std::vector<TileChange> changedTiles(const Version& before, const Version& after) {
  assert(before.grid().width == after.grid().width && before.grid().height == after.grid().height);
  std::vector<TileChange> changes;
  descend(before.reader().root(), after.reader().root(), 0, 0, changes);
  return changes;
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
