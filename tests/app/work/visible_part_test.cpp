#include "app/work/visible_part.h"

#include <vector>

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

engine::Grid gridOf(int width, int height) {
  engine::Grid grid;
  grid.width = width;
  grid.height = height;
  return grid;
}

TEST(VisiblePart, covers_what_is_seen_and_a_step_around_it) {
  for (const int side : {300, 5000, 100000}) {
    const engine::Grid grid = gridOf(side, side);
    const std::vector<Seen> seen{{side / 4, side / 4}, {side / 2, side / 3}, {side / 2, side / 2}};
    const engine::FieldView view = visiblePart(grid, seen, {side * 3 / 8, side * 3 / 8});
    EXPECT_EQ(view.column, side * 3 / 8);
    EXPECT_EQ(view.row, side * 3 / 8);
    const int step = (side / 2 - side / 4) / 8;
    EXPECT_EQ(view.tiles.column, (side / 4 - step) / 64);
    EXPECT_EQ(view.tiles.row, (side / 4 - step) / 64);
    EXPECT_EQ(view.tiles.column + view.tiles.columns - 1, (side / 2 + step) / 64);
    EXPECT_EQ(view.tiles.row + view.tiles.rows - 1, (side / 2 + step) / 64);
  }
}

TEST(VisiblePart, stays_in_the_field_and_is_nothing_when_nothing_is_seen) {
  EXPECT_TRUE(visiblePart(gridOf(100, 100), {}, {50, 50}).tiles.empty());
  const std::vector<Seen> corners{{0, 0}, {99, 69}};
  const engine::FieldView view = visiblePart(gridOf(100, 70), corners, {-500, 900});
  EXPECT_EQ(view.tiles, (engine::TileRange{0, 0, 2, 2}));
}

}  // namespace
}  // namespace fettle::app
