#pragma once

#include <cstdint>

#include "engine/field/version.h"

namespace fettle::engine::detail {

/// Calls tile(column, row, before, after) for every tile that two trees of the same shape do not share,
/// row-major within each node; `column`, `row` of the first tile below the pair. Returns how many pairs of
/// nodes were compared. Time is proportional to the differences. Wait-free; throws only what `tile` throws.
std::int64_t walkChanges(const Node& before, const Node& after, std::int32_t column, std::int32_t row,
                         const auto& tile) {
  if (&before == &after) return 0;
  std::int64_t nodes = 1;
  const std::int32_t tiles_a_child = 1 << (3 * (before.level - 2));
  for (int k = 0; k < kFanOut; ++k) {
    const void* a = before.children[k];
    const void* b = after.children[k];
    if (a == b) continue;
    const std::int32_t c = column + (k % 8) * tiles_a_child;
    const std::int32_t r = row + (k / 8) * tiles_a_child;
    if (before.level == 2)
      tile(c, r, *static_cast<const Tile*>(a), *static_cast<const Tile*>(b));
    else
      nodes += walkChanges(*static_cast<const Node*>(a), *static_cast<const Node*>(b), c, r, tile);
  }
  return nodes;
}

}  // namespace fettle::engine::detail
