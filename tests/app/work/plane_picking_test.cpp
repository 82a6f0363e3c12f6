#include "app/work/plane_picking.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

engine::Grid gridOf() {
  engine::Grid grid;
  grid.width = 101;
  grid.height = 51;
  grid.spacing_x = grid.spacing_y = 0.1;
  return grid;
}

TEST(PlanePicking, sets_three_points_one_after_the_other) {
  engine::FormChoice choice{.kind = engine::FormKind::kCylinder, .robust = true};
  PlanePicking picking;
  EXPECT_TRUE(picking.set(choice).empty());
  picking.begin(choice, gridOf());
  EXPECT_EQ(choice.kind, engine::FormKind::kPlane);
  EXPECT_FALSE(choice.robust) << "around three points all samples count";
  ASSERT_TRUE(choice.through);
  EXPECT_EQ(picking.next(), 0U);
  EXPECT_TRUE(picking.set(choice).empty()) << "none of them was set by a person";
  const glm::dvec2 points[] = {{1.0, 2.0}, {3.0, 1.0}, {9.0, 4.0}};
  EXPECT_FALSE(picking.take(points[0], choice));
  EXPECT_FALSE(picking.take(points[1], choice));
  EXPECT_EQ(picking.next(), 2U);
  EXPECT_EQ(picking.set(choice).size(), 2U);
  EXPECT_TRUE(picking.take(points[2], choice));
  EXPECT_FALSE(picking.next());
  ASSERT_EQ(picking.set(choice).size(), 3U);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(picking.set(choice)[static_cast<std::size_t>(i)], points[i]);
  picking.leave(choice);
  EXPECT_TRUE(choice.through) << "what was set stays";
}

TEST(PlanePicking, leaves_the_choice_as_it_was_before) {
  const engine::FormChoice before{.kind = engine::FormKind::kSphere, .robust = true};
  engine::FormChoice choice = before;
  PlanePicking picking;
  picking.begin(choice, gridOf());
  (void)picking.take({1.0, 2.0}, choice);
  picking.leave(choice);
  EXPECT_EQ(choice, before);
  EXPECT_FALSE(picking.next());
}

TEST(PlanePicking, keeps_points_and_radius_that_are_there_and_begins_with_a_triangle_within_the_field) {
  engine::FormChoice choice;
  choosePlaneByPoints(choice, gridOf());
  const engine::ThreePoints first = *choice.through;
  for (const glm::dvec2& at : first.at_mm) {
    EXPECT_GT(at.x, 0.0);
    EXPECT_LT(at.x, 10.0);
    EXPECT_GT(at.y, 0.0);
    EXPECT_LT(at.y, 5.0);
  }
  choice.through->at_mm[1] = {2.0, 2.0};
  choice.through->radius_mm = 0.7;
  const engine::ThreePoints typed = *choice.through;
  choosePlaneByPoints(choice, gridOf());
  EXPECT_EQ(*choice.through, typed);
  PlanePicking picking;
  picking.begin(choice, gridOf());
  EXPECT_EQ(choice.through->radius_mm, 0.7);
  picking.stop();
  EXPECT_EQ(*choice.through, typed);
}

}  // namespace
}  // namespace fettle::app
