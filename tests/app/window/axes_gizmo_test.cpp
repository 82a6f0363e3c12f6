#include "app/window/axes_gizmo.h"

#include <stdexcept>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

namespace fettle::app {
namespace {

const render::Rectangle kGizmoPlot{24, 60, 640, 480};

render::View gizmoView(double azimuth, double elevation) {
  render::View view;
  view.azimuth_deg = azimuth;
  view.elevation_deg = elevation;
  return view;
}

const AxesGizmo::Ball& ballOf(const AxesGizmo& gizmo, int axis, bool positive) {
  for (const AxesGizmo::Ball& ball : gizmo.balls())
    if (ball.axis == axis && ball.positive == positive) return ball;
  throw std::logic_error("no such ball");
}

TEST(AxesGizmo, shows_the_axes_as_the_view_shows_the_field) {
  const AxesGizmo above(gizmoView(0, 90), kGizmoPlot, 1.0);
  EXPECT_GT(ballOf(above, 0, true).at.x, above.middle().x + 20.0);
  EXPECT_NEAR(ballOf(above, 0, true).at.y, above.middle().y, 1e-9);
  EXPECT_LT(ballOf(above, 1, true).at.y, above.middle().y - 20.0) << "y up the picture";
  EXPECT_NEAR(glm::distance(ballOf(above, 2, true).at, above.middle()), 0.0, 1e-9);
  EXPECT_EQ(above.balls().back().axis, 2) << "nearest";
  EXPECT_TRUE(above.balls().back().positive);
  const AxesGizmo right(gizmoView(90, 0), kGizmoPlot, 1.0);
  EXPECT_GT(ballOf(right, 1, true).at.x, right.middle().x + 20.0);
  EXPECT_LT(ballOf(right, 2, true).at.y, right.middle().y - 20.0);
  EXPECT_EQ(right.balls().back().axis, 0);
}

TEST(AxesGizmo, a_ball_looks_from_where_it_is) {
  const AxesGizmo gizmo(gizmoView(330, 30), kGizmoPlot, 2.0);
  const auto clicked = [&](int axis, bool positive) -> std::optional<Action> {
    const AxesGizmo::Ball* const ball = gizmo.under(ballOf(gizmo, axis, positive).at);
    return ball != nullptr ? ball->action : std::nullopt;
  };
  EXPECT_EQ(clicked(0, true), Action::kViewRight);
  EXPECT_EQ(clicked(0, false), Action::kViewLeft);
  EXPECT_EQ(clicked(1, true), Action::kViewBack);
  EXPECT_EQ(clicked(1, false), Action::kViewFront);
  EXPECT_EQ(clicked(2, true), Action::kViewTop);
  EXPECT_EQ(clicked(2, false), std::nullopt) << "there is no view from below";
  EXPECT_EQ(gizmo.under({100.0, 300.0}), nullptr);
}

TEST(AxesGizmo, of_two_balls_behind_each_other_the_near_one_is_meant) {
  const AxesGizmo front(gizmoView(0, 0), kGizmoPlot, 1.0);
  EXPECT_EQ(front.under(front.middle())->action, Action::kViewFront);
  const AxesGizmo back(gizmoView(180, 0), kGizmoPlot, 1.0);
  EXPECT_EQ(back.under(back.middle())->action, Action::kViewBack);
}

TEST(AxesGizmo, lies_in_its_plot_and_is_absent_where_that_is_small) {
  for (const double scale : {0.5, 1.0, 1.5})
    for (const double azimuth : {0.0, 45.0, 200.0})
      for (const double elevation : {0.0, 35.0, 90.0}) {
        const AxesGizmo gizmo(gizmoView(azimuth, elevation), kGizmoPlot, scale);
        ASSERT_TRUE(gizmo.shown());
        for (const AxesGizmo::Ball& ball : gizmo.balls()) {
          EXPECT_LT(ball.at.x + gizmo.ballRadius(), kGizmoPlot.x + kGizmoPlot.width);
          EXPECT_GT(ball.at.y - gizmo.ballRadius(), kGizmoPlot.y);
        }
      }
  const AxesGizmo small(gizmoView(0, 0), {0, 0, 120, 400}, 1.0);
  EXPECT_FALSE(small.shown());
  EXPECT_EQ(small.under(small.middle()), nullptr);
}

}  // namespace
}  // namespace fettle::app
