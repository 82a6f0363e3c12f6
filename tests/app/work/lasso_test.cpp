#include "app/work/lasso.h"

#include <gtest/gtest.h>

#include "engine/field/builder.h"

namespace fettle::app {
namespace {

engine::Grid gridOf(int side, double spacing) {
  engine::Grid grid;
  grid.width = grid.height = side;
  grid.spacing_x = grid.spacing_y = spacing;
  return grid;
}

// A picture that shows the field at two pixels a millimetre, upside down as pictures are.
std::optional<glm::dvec2> map(const glm::dvec2& pixel) {
  return glm::dvec2(pixel.x / 2.0, 50.0 - pixel.y / 2.0);
}

std::int64_t markedBy(const engine::Polygon& polygon, const engine::Grid& grid) {
  const engine::Version field =
      engine::makeField(grid, std::vector<float>(static_cast<std::size_t>(grid.samples()), 0.0F));
  engine::JobControl job;
  return engine::summarize(*engine::markPolygon(field, polygon, engine::MarkChange::kMark, job)).marked;
}

TEST(Lasso, a_line_drawn_by_hand_marks_what_is_inside) {
  Lasso lasso;
  lasso.begin(Lasso::Shape::kFree, {10, 10});
  EXPECT_FALSE(lasso.set());
  // 11 .. 41 pixels both ways: 5.5 .. 20.5 mm, with samples of 0.5 mm the columns 11 .. 40.
  for (int x = 11; x <= 41; ++x) lasso.move({x, 11.0}, Lasso::Drawing::kYes);
  for (int y = 11; y <= 41; ++y) lasso.move({41.0, y}, Lasso::Drawing::kYes);
  for (int x = 41; x >= 11; --x) lasso.move({x, 41.0}, Lasso::Drawing::kYes);
  ASSERT_TRUE(lasso.closes());
  const engine::Grid grid = gridOf(100, 0.5);
  const std::int64_t marked = markedBy(lasso.finish(grid, map), grid);
  EXPECT_FALSE(lasso.active());
  // 30 x 30 samples but for what the first corner at (10, 10) and the rounding of the line's two-pixel pieces
  // add or cut: less than a row on each side.
  EXPECT_NEAR(static_cast<double>(marked), 900.0, 4 * 31.0);
}

TEST(Lasso, corners_set_by_keys_make_a_box_with_the_second) {
  Lasso lasso;
  lasso.begin(Lasso::Shape::kBox, {20, 20});
  EXPECT_FALSE(lasso.set());
  lasso.move({60, 40}, Lasso::Drawing::kNo);
  EXPECT_EQ(lasso.line().size(), 4U);
  EXPECT_TRUE(lasso.set());
  // 10 .. 30 mm and 30 .. 40 mm, one side of each shut in.
  const engine::Grid grid = gridOf(101, 0.5);
  EXPECT_EQ(markedBy(lasso.finish(grid, map), grid), 40 * 20);
}

TEST(Lasso, corners_are_taken_back_and_a_click_alone_closes_nothing) {
  Lasso lasso;
  lasso.begin(Lasso::Shape::kFree, {20, 20});
  (void)lasso.set();
  EXPECT_FALSE(lasso.set());
  EXPECT_FALSE(lasso.closes());
  lasso.move({60, 20}, Lasso::Drawing::kNo);
  (void)lasso.set();
  lasso.move({60, 60}, Lasso::Drawing::kNo);
  EXPECT_TRUE(lasso.closes());
  EXPECT_TRUE(lasso.takeBack());
  EXPECT_TRUE(lasso.takeBack());
  EXPECT_FALSE(lasso.takeBack());
  EXPECT_FALSE(lasso.closes());
}

TEST(Lasso, places_that_lie_nowhere_are_left_out) {
  Lasso lasso;
  lasso.begin(Lasso::Shape::kBox, {0, 0});
  (void)lasso.set();
  lasso.move({100, 100}, Lasso::Drawing::kNo);
  const engine::Polygon none =
      lasso.finish(gridOf(100, 0.5), [](const glm::dvec2&) { return std::optional<glm::dvec2>(); });
  EXPECT_TRUE(none.empty());
}

}  // namespace
}  // namespace fettle::app
