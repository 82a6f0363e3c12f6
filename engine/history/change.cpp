#include "engine/history/change.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "engine/field/difference_inl.h"

namespace fettle::engine {

namespace {

struct Extent {
  std::int32_t column0 = std::numeric_limits<std::int32_t>::max(), row0 = column0;  // tiles
  std::int32_t column1 = -1, row1 = -1;                                             // the last ones
};

bool runAlike(const EdgeLine& a, const EdgeLine& b) noexcept {
  return a.id == b.id && a.closed == b.closed &&
         std::ranges::equal(a.points, b.points, {}, &EdgePoint::position, &EdgePoint::position);
}

// Around the points of the lines that are not among the others, clipped to the field.
SampleRect rectOfOtherLines(const EdgeLines& lines, const EdgeLines& others, const Grid& grid) noexcept {
  SampleRect rect;
  if (lines == nullptr) return rect;
  std::size_t next = 0;  // lines keep their order: the search begins after the last one found
  const auto isAmong = [&](const EdgeLine& line) {
    const std::size_t n = others == nullptr ? 0 : others->size();
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t at = (next + i) % n;
      if (!runAlike(line, (*others)[at])) continue;
      next = at + 1;
      return true;
    }
    return false;
  };
  for (const EdgeLine& line : *lines) {
    if (isAmong(line)) continue;
    for (const EdgePoint& point : line.points) {
      const auto column = static_cast<std::int32_t>(std::clamp(point.position.x, 0.0, grid.width - 1.0));
      const auto row = static_cast<std::int32_t>(std::clamp(point.position.y, 0.0, grid.height - 1.0));
      rect = rect.joined({column, row, 1, 1});
    }
  }
  return rect;
}

}  // namespace

Change measureChange(const Version& before, const Version& after) noexcept {
  const Grid& grid = before.grid();
  assert(grid.width == after.grid().width && grid.height == after.grid().height);
  Change change;
  change.inverted = before.reader().sign() != after.reader().sign();
  change.lines = before.lines() != after.lines();
  Extent extent;
  change.nodes = detail::walkChanges(before.reader().root(), after.reader().root(), 0, 0,
                                     [&](std::int32_t column, std::int32_t row, const Tile&, const Tile&) {
                                       ++change.tiles;
                                       extent.column0 = std::min(extent.column0, column);
                                       extent.row0 = std::min(extent.row0, row);
                                       extent.column1 = std::max(extent.column1, column);
                                       extent.row1 = std::max(extent.row1, row);
                                     });
  if (change.inverted) {
    change.rect = {0, 0, grid.width, grid.height};
  } else if (change.tiles != 0) {
    const std::int32_t column = extent.column0 * kTileSide;
    const std::int32_t row = extent.row0 * kTileSide;
    change.rect = {column, row, std::min((extent.column1 + 1) * kTileSide, grid.width) - column,
                   std::min((extent.row1 + 1) * kTileSide, grid.height) - row};
  }
  if (change.lines && after.lines() != nullptr)
    change.line_bytes = static_cast<std::size_t>(countPoints(*after.lines())) * sizeof(EdgePoint);
  if (change.lines)
    change.rect = change.rect.joined(rectOfOtherLines(before.lines(), after.lines(), grid))
                      .joined(rectOfOtherLines(after.lines(), before.lines(), grid));
  return change;
}

}  // namespace fettle::engine
