#include "engine/history/change.h"

#include <algorithm>
#include <cassert>
#include <limits>

namespace fettle::engine {

namespace {

struct Extent {
  std::int32_t column0 = std::numeric_limits<std::int32_t>::max(), row0 = column0;  // tiles
  std::int32_t column1 = -1, row1 = -1;                                             // the last ones
};

void descend(const Node& before, const Node& after, std::int32_t tc, std::int32_t tr, Change& change,
             Extent& extent) noexcept {
  ++change.nodes;
  const std::int32_t tiles_a_child = 1 << (3 * (before.level - 2));
  for (int k = 0; k < kFanOut; ++k) {
    const void* a = before.children[k];
    const void* b = after.children[k];
    if (a == b) continue;
    const std::int32_t column = tc + (k % 8) * tiles_a_child;
    const std::int32_t row = tr + (k / 8) * tiles_a_child;
    if (before.level == 2) {
      ++change.tiles;
      extent.column0 = std::min(extent.column0, column);
      extent.row0 = std::min(extent.row0, row);
      extent.column1 = std::max(extent.column1, column);
      extent.row1 = std::max(extent.row1, row);
    } else {
      descend(*static_cast<const Node*>(a), *static_cast<const Node*>(b), column, row, change, extent);
    }
  }
}

}  // namespace

Change measureChange(const Version& before, const Version& after) noexcept {
  const Grid& grid = before.grid();
  assert(grid.width == after.grid().width && grid.height == after.grid().height);
  Change change;
  change.inverted = before.reader().sign() != after.reader().sign();
  Extent extent;
  const Node& a = before.reader().root();
  const Node& b = after.reader().root();
  if (&a != &b) descend(a, b, 0, 0, change, extent);
  if (change.inverted) {
    change.rect = {0, 0, grid.width, grid.height};
  } else if (change.tiles != 0) {
    const std::int32_t column = extent.column0 * kTileSide;
    const std::int32_t row = extent.row0 * kTileSide;
    change.rect = {column, row, std::min((extent.column1 + 1) * kTileSide, grid.width) - column,
                   std::min((extent.row1 + 1) * kTileSide, grid.height) - row};
  }
  return change;
}

}  // namespace fettle::engine
