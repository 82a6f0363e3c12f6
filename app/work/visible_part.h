#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/field/sample_rect.h"

namespace fettle::app {

/// A visible sample.
struct Seen {
  std::int32_t column = 0, row = 0;
};

/// The part of a field to process first: squares of tiles that cover the visible samples, the one nearest to
/// `middle` first. Squares have 4 x 4 tiles, more on larger views, so that there are at most about 400. Empty
/// when nothing is visible.
[[nodiscard]] std::vector<engine::TileRange> visiblePart(const engine::Grid& grid, std::span<const Seen> seen,
                                                         const Seen& middle);

}  // namespace fettle::app
