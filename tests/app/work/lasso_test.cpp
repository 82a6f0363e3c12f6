#include "app/work/lasso.h"

#include <optional>
#include <vector>

#include <gtest/gtest.h>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

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
const Lasso::Places kFromAbove{
    [](const glm::dvec2& pixel) {
      return std::optional(glm::dvec3(pixel.x / 2.0, 50.0 - pixel.y / 2.0, 0.0));
    },
    [](const glm::dvec2&, std::optional<double>) { return std::optional<glm::dvec2>(); }};

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
  const std::int64_t marked = markedBy(lasso.finish(grid, kFromAbove), grid);
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
  EXPECT_EQ(markedBy(lasso.finish(grid, kFromAbove), grid), 40 * 20);
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

// A picture seen aslant of a part 8 mm below the middle of all heights, with no surface in its lower half.
TEST(Lasso, over_holes_a_line_goes_on_at_the_height_beside_them) {
  constexpr double kHeight = -8.0;
  const auto seenAt = [](const glm::dvec2& pixel, double height) {
    return glm::dvec2(pixel.x / 2.0, pixel.y / 2.0 + height);
  };
  std::vector<std::optional<double>> heights;
  const Lasso::Places aslant{[&](const glm::dvec2& pixel) -> std::optional<glm::dvec3> {
                               if (pixel.y > 60.0) return std::nullopt;
                               return glm::dvec3(seenAt(pixel, kHeight), kHeight);
                             },
                             [&](const glm::dvec2& pixel, std::optional<double> height) {
                               heights.push_back(height);
                               return std::optional(seenAt(pixel, height.value_or(0.0)));
                             }};
  Lasso lasso;
  lasso.begin(Lasso::Shape::kBox, {20, 40});
  (void)lasso.set();
  lasso.move({60, 80}, Lasso::Drawing::kNo);
  EXPECT_TRUE(lasso.set());
  const engine::Grid grid = gridOf(101, 0.5);
  // 10 .. 30 mm and 12 .. 32 mm, one side of each shut in; the plane in the middle of all heights would end at 40 mm.
  EXPECT_EQ(markedBy(lasso.finish(grid, aslant), grid), 40 * 40);
  ASSERT_FALSE(heights.empty());
  for (const auto& height : heights) EXPECT_EQ(height, kHeight);
}

TEST(Lasso, places_that_lie_nowhere_are_left_out) {
  Lasso lasso;
  lasso.begin(Lasso::Shape::kBox, {0, 0});
  (void)lasso.set();
  lasso.move({100, 100}, Lasso::Drawing::kNo);
  const engine::Polygon none =
      lasso.finish(gridOf(100, 0.5),
                   {[](const glm::dvec2&) { return std::optional<glm::dvec3>(); },
                    [](const glm::dvec2&, std::optional<double>) { return std::optional<glm::dvec2>(); }});
  EXPECT_TRUE(none.empty());
}

}  // namespace
}  // namespace fettle::app
