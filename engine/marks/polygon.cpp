#include "engine/marks/polygon.h"

#include <algorithm>
#include <cmath>

namespace fettle::engine {

namespace {

constexpr double kFarthest = 1 << 20;  // [samples]: products of two differences stay below 2^60

std::int64_t floorDiv(std::int64_t a, std::int64_t b) noexcept {
  const std::int64_t q = a / b;
  return q * b > a ? q - 1 : q;
}
std::int64_t ceilDiv(std::int64_t a, std::int64_t b) noexcept {
  return -floorDiv(-a, b);
}

std::int64_t fixed(double samples) noexcept {
  return std::llround(std::clamp(samples, -kFarthest, kFarthest) * Polygon::kSteps);
}

}  // namespace

Polygon::Polygon(std::span<const glm::dvec2> corners_samples) {
  struct Corner {
    std::int64_t x, y;
  };
  std::vector<Corner> corners;
  for (const glm::dvec2& p : corners_samples)
    if (std::isfinite(p.x) && std::isfinite(p.y)) corners.push_back({fixed(p.x), fixed(p.y)});
  if (corners.size() < 3) return;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    Corner a = corners[i], b = corners[(i + 1) % corners.size()];
    if (a.y == b.y) continue;  // no ray of a row crosses it
    if (a.y > b.y) std::swap(a, b);
    edges_.push_back({a.x, a.y, b.x - a.x, b.y - a.y});
  }
  if (edges_.empty()) return;
  std::sort(edges_.begin(), edges_.end(), [](const Edge& a, const Edge& b) { return a.y < b.y; });
  const auto [left, right] = std::minmax_element(corners.begin(), corners.end(),
                                                 [](const Corner& a, const Corner& b) { return a.x < b.x; });
  low_x_ = left->x;
  high_x_ = right->x;
  low_y_ = edges_.front().y;
  high_y_ = low_y_;
  highest_.reserve(edges_.size());
  for (const Edge& e : edges_) {
    high_y_ = std::max(high_y_, e.y + e.dy);
    highest_.push_back(high_y_);
  }
}

TileRange Polygon::tiles(const Grid& grid) const noexcept {
  if (empty()) return {};
  const auto tileOf = [](std::int64_t steps, std::int32_t side) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(
        floorDiv(steps, std::int64_t{kSteps} * kTileSide), -1, (side + kTileSide - 1) / kTileSide));
  };
  const std::int32_t c0 = tileOf(low_x_, grid.width), c1 = tileOf(high_x_, grid.width);
  const std::int32_t r0 = tileOf(low_y_, grid.height), r1 = tileOf(high_y_, grid.height);
  return {c0, r0, c1 - c0 + 1, r1 - r0 + 1};
}

MarkRows Polygon::inside(std::int32_t tile_column, std::int32_t tile_row) const {
  MarkRows rows{};
  const std::int64_t first_column = std::int64_t{tile_column} * kTileSide;
  const std::int64_t first_row = std::int64_t{tile_row} * kTileSide;
  const std::int64_t below = first_row * kSteps, above = (first_row + kTileSide - 1) * kSteps;
  // Edges that begin above the tile's last row cross none of its rows, and neither do those before the first
  // one with an upper end above the tile's first row.
  const auto end = std::upper_bound(edges_.begin(), edges_.end(), above,
                                    [](std::int64_t y, const Edge& e) { return y < e.y; });
  const auto skip = std::upper_bound(highest_.begin(), highest_.end(), below) - highest_.begin();
  for (auto e = edges_.begin() + skip; e < end; ++e) {
    // Rows r with e.y <= r < e.y + e.dy: lower ends belong, upper ends do not.
    const std::int64_t from = std::max(ceilDiv(e->y, kSteps), first_row);
    const std::int64_t to = std::min(ceilDiv(e->y + e->dy, kSteps), first_row + kTileSide);
    for (std::int64_t r = from; r < to; ++r) {
      // The first column at or to the right of the crossing; all from there on change sides.
      const std::int64_t numerator = e->x * e->dy + (r * kSteps - e->y) * e->dx;
      const std::int64_t column = ceilDiv(numerator, e->dy * kSteps) - first_column;
      if (column >= kTileSide) continue;
      rows[static_cast<std::size_t>(r - first_row)] ^=
          column <= 0 ? ~std::uint64_t{0} : ~std::uint64_t{0} << column;
    }
  }
  return rows;
}

Result<Version> markPolygon(const Version& field, const Polygon& polygon, MarkChange change,
                            JobControl& job) {
  return changeMarks(
      field, polygon.tiles(field.grid()),
      [&](std::int32_t tc, std::int32_t tr, const Tile& tile, MarkRows& rows) {
        applyChange(tile, polygon.inside(tc, tr), change, rows);
      },
      job);
}

}  // namespace fettle::engine
