#include "app/window/pen_hold.h"

#include <cmath>

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

TEST(PenHold, pressure_is_the_share_of_the_depth) {
  const render::Pen pen{0.25, std::nullopt, false};
  EXPECT_EQ(penHold(pen, {}, {}).share, 0.25);
  EXPECT_EQ(penHold(pen, {true, 0.5}, {}).share, 0.5) << "a soft pen is deep at once";
  EXPECT_EQ(penHold(pen, {true, 2.0}, {}).share, 0.0625);
  EXPECT_EQ(penHold(pen, {false, 2.0}, {}).share, 1.0) << "the depth of the mouse";
  EXPECT_EQ(penHold({0.0, std::nullopt, false}, {}, {}).share, 0.0);
}

TEST(PenHold, it_leans_over_the_picture_as_over_the_tablet) {
  EXPECT_FALSE(penHold({0.5, std::nullopt, false}, {}, {}).to_hand);
  // Seen from above, the picture's top is the field's y.
  const render::ViewAxes above;
  const auto upright = penHold({0.5, glm::dvec2(0.0), false}, {}, above).to_hand;
  ASSERT_TRUE(upright);
  EXPECT_EQ(*upright, glm::dvec3(0.0, 0.0, 1.0));
  const auto right = penHold({0.5, glm::dvec2(45.0, 0.0), false}, {}, above).to_hand;
  EXPECT_NEAR(right->x, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(right->z, std::sqrt(0.5), 1e-12);
  const auto to_user = penHold({0.5, glm::dvec2(0.0, 45.0), false}, {}, above).to_hand;
  EXPECT_NEAR(to_user->y, -std::sqrt(0.5), 1e-12) << "to the picture's lower edge";
  // Seen from the side, what leans to the right of the picture leans so in the field.
  const render::ViewAxes side{{0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}};
  const auto seen = penHold({0.5, glm::dvec2(45.0, 0.0), false}, {}, side).to_hand;
  EXPECT_NEAR(seen->y, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(seen->x, std::sqrt(0.5), 1e-12);
}

TEST(PenHold, a_pen_that_lies_flat_has_a_direction) {
  for (const double deg : {90.0, -90.0, 1e9}) {
    const auto flat = penHold({0.5, glm::dvec2(deg, deg), false}, {}, {}).to_hand;
    ASSERT_TRUE(flat);
    EXPECT_NEAR(glm::length(*flat), 1.0, 1e-12) << deg;
  }
}

}  // namespace
}  // namespace fettle::app
