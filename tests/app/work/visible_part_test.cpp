#include "app/work/visible_part.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

engine::Grid gridOf(int width, int height) {
  engine::Grid grid;
  grid.width = width;
  grid.height = height;
  return grid;
}

TEST(VisiblePart, covers_what_is_seen_once_and_begins_in_the_middle) {
  for (const int side : {300, 5000, 100000}) {
    const engine::Grid grid = gridOf(side, side);
    const std::vector<Seen> seen{{side / 4, side / 4}, {side / 2, side / 3}, {side / 2, side / 2}};
    const Seen middle{side * 3 / 8, side * 3 / 8};
    const auto part = visiblePart(grid, seen, middle);
    ASSERT_FALSE(part.empty());
    EXPECT_LE(part.size(), 450U);
    std::set<std::pair<int, int>> tiles;
    double last = -1.0;
    for (const engine::TileRange& range : part) {
      EXPECT_FALSE(range.empty());
      for (int r = range.row; r < range.row + range.rows; ++r)
        for (int c = range.column; c < range.column + range.columns; ++c)
          EXPECT_TRUE(tiles.insert({c, r}).second) << "twice";
      const double x = (range.column + 0.5 * range.columns) * 64 - middle.column;
      const double y = (range.row + 0.5 * range.rows) * 64 - middle.row;
      EXPECT_GE(std::hypot(x, y), last - 1e-9);
      last = std::hypot(x, y);
    }
    for (const Seen& s : seen) EXPECT_TRUE(tiles.contains({s.column / 64, s.row / 64}));
    EXPECT_LE(tiles.size(), static_cast<std::size_t>(side) * side / 4096 + 2 * side / 64 + 1);
  }
}

TEST(VisiblePart, stays_in_the_field_and_is_nothing_when_nothing_is_seen) {
  EXPECT_TRUE(visiblePart(gridOf(100, 100), {}, {50, 50}).empty());
  const std::vector<Seen> corners{{0, 0}, {99, 69}};
  for (const engine::TileRange& range : visiblePart(gridOf(100, 70), corners, {-500, 900})) {
    EXPECT_GE(range.column, 0);
    EXPECT_GE(range.row, 0);
    EXPECT_LE(range.column + range.columns, 2);
    EXPECT_LE(range.row + range.rows, 2);
  }
}

}  // namespace
}  // namespace fettle::app
