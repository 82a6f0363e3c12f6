#include "app/work/visible_part.h"

#include <algorithm>

namespace fettle::app {

constexpr std::int32_t kSmallest = 4;  // tiles along a square
constexpr std::int32_t kMostAlong = 20;

std::vector<engine::TileRange> visiblePart(const engine::Grid& grid, std::span<const Seen> seen,
                                           const Seen& middle) {
  if (seen.empty()) return {};
  std::int32_t c0 = grid.width, c1 = -1, r0 = grid.height, r1 = -1;
  for (const Seen& s : seen) {
    c0 = std::min(c0, s.column), c1 = std::max(c1, s.column);
    r0 = std::min(r0, s.row), r1 = std::max(r1, s.row);
  }
  // The points seen are one step apart: add one step on each side.
  const auto step = [&](std::int32_t low, std::int32_t high) { return (high - low) / 8; };
  const std::int32_t dc = step(c0, c1), dr = step(r0, r1);
  c0 = std::clamp(c0 - dc, 0, grid.width - 1) / engine::kTileSide;
  c1 = std::clamp(c1 + dc, 0, grid.width - 1) / engine::kTileSide;
  r0 = std::clamp(r0 - dr, 0, grid.height - 1) / engine::kTileSide;
  r1 = std::clamp(r1 + dr, 0, grid.height - 1) / engine::kTileSide;
  const std::int32_t side = std::max({kSmallest, (c1 - c0) / kMostAlong + 1, (r1 - r0) / kMostAlong + 1});
  struct Square {
    engine::TileRange range;
    double distance;
  };
  std::vector<Square> squares;
  for (std::int32_t r = r0; r <= r1; r += side)
    for (std::int32_t c = c0; c <= c1; c += side) {
      const engine::TileRange range{c, r, std::min(side, c1 - c + 1), std::min(side, r1 - r + 1)};
      const double x = (c + 0.5 * range.columns) * engine::kTileSide - middle.column;
      const double y = (r + 0.5 * range.rows) * engine::kTileSide - middle.row;
      squares.push_back({range, x * x + y * y});
    }
  std::stable_sort(squares.begin(), squares.end(),
                   [](const Square& a, const Square& b) { return a.distance < b.distance; });
  std::vector<engine::TileRange> ranges;
  for (const Square& square : squares) ranges.push_back(square.range);
  return ranges;
}

}  // namespace fettle::app
