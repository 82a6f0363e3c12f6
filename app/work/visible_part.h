#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/field/tile_range.h"

namespace fettle::app {

/// A sample that a person sees.
struct Seen {
  std::int32_t column = 0, row = 0;
};

/// The part of a field that work should begin with: squares of tiles that cover what lies between the samples
/// seen, the one nearest to `middle` first. Squares are of 4 x 4 tiles, larger ones on larger views, so that
/// there are at most some 400. None when nothing is seen.
[[nodiscard]] std::vector<engine::TileRange> visiblePart(const engine::Grid& grid, std::span<const Seen> seen,
                                                         const Seen& middle);

}  // namespace fettle::app
