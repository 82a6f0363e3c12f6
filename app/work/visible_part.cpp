#include "app/work/visible_part.h"

#include <algorithm>

namespace fettle::app {

engine::FieldView visiblePart(const engine::Grid& grid, std::span<const Seen> seen, const Seen& middle) {
  engine::FieldView view{{}, middle.column, middle.row};
  if (seen.empty()) return view;
  std::int32_t c0 = grid.width, c1 = -1, r0 = grid.height, r1 = -1;
  for (const Seen& s : seen) {
    c0 = std::min(c0, s.column), c1 = std::max(c1, s.column);
    r0 = std::min(r0, s.row), r1 = std::max(r1, s.row);
  }
  // The points seen are one step apart: add one step on each side.
  const auto step = [](std::int32_t low, std::int32_t high) { return (high - low) / 8; };
  const std::int32_t dc = step(c0, c1), dr = step(r0, r1);
  const auto tileOf = [](std::int32_t sample, std::int32_t side) {
    return std::clamp(sample, 0, side - 1) / engine::kTileSide;
  };
  const std::int32_t left = tileOf(c0 - dc, grid.width), low = tileOf(r0 - dr, grid.height);
  view.tiles = {left, low, tileOf(c1 + dc, grid.width) - left + 1, tileOf(r1 + dr, grid.height) - low + 1};
  return view;
}

}  // namespace fettle::app
