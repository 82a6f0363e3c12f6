#include "render/plan/stylus_body.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "render/plan/plan.h"
#include "tests/render/support/fields.h"

namespace fettle::render {
namespace {

PanelPlan panelOf(double exaggeration) {
  const std::vector<engine::Version> fields{fieldOf(gridOf(64, 64), [](int c, int) { return c; })};
  PictureSpec spec;
  spec.view.vertical_exaggeration = exaggeration;
  return planPicture(spec, fields, spansOf(fields, {}), layOut(spec.view, spec.decoration, 1, Titles::kNone))
      ->panels[0];
}

TEST(StylusBody, IsNotDrawnWhereAnyCoordinateIsNoNumber) {
  const PanelPlan panel = panelOf(1.0);
  StylusBody good;
  good.tip_mm = {3.0, 4.0, 5.0};
  good.to_tail = glm::dvec3{0.0, 0.0, 2.0};
  ASSERT_TRUE(stylusIn(panel, good));
  for (const double wrong : {std::nan(""), std::numeric_limits<double>::infinity()})
    for (int axis = 0; axis < 3; ++axis) {
      StylusBody body = good;
      body.tip_mm[axis] = wrong;
      EXPECT_FALSE(stylusIn(panel, body)) << axis;
      body = good;
      (*body.to_tail)[axis] = wrong;
      EXPECT_FALSE(stylusIn(panel, body)) << axis;
      body = good;
      body.length_px = wrong;
      EXPECT_FALSE(stylusIn(panel, body));
    }
  StylusBody nowhere = good;
  nowhere.to_tail = glm::dvec3{0.0};
  EXPECT_FALSE(stylusIn(panel, nowhere)) << "no direction";
  // A device that does not say how it is held: the usual way, of any length of the direction the same pen.
  good.to_tail.reset();
  EXPECT_TRUE(stylusIn(panel, good));
}

TEST(StylusBody, LeavesItsBallAtTheBallsSurfaceAlsoWhereHeightsAreExaggerated) {
  for (const double exaggeration : {1.0, 5.0}) {
    const PanelPlan panel = panelOf(exaggeration);
    StylusBody body;
    body.tip_mm = {3.0, 4.0, 5.0};
    body.to_tail = glm::dvec3{1.0, 2.0, 2.0};
    body.ball_radius_mm = 1.5;
    const auto ball = stylusIn(panel, body);
    ASSERT_TRUE(ball);
    const glm::dvec3 from_centre = glm::dvec3(glm::vec3(ball->point) - glm::vec3(ball->ball));
    // On the ellipsoid (x^2 + y^2) / r^2 + (z / (e r))^2 = 1, in floats of about 30.
    EXPECT_NEAR(glm::length(from_centre / (1.5 * glm::dvec3(1.0, 1.0, exaggeration))), 1.0, 1e-5);
    EXPECT_NEAR(glm::dot(glm::normalize(from_centre), glm::normalize(*body.to_tail)), 1.0, 1e-9);
    EXPECT_FLOAT_EQ(ball->ball.w, static_cast<float>(1.5 * exaggeration));
    // The pen is as long as asked for, whatever the direction's length.
    body.to_tail = 7.0 * *body.to_tail;
    const auto again = stylusIn(panel, body);
    EXPECT_EQ(again->tail, ball->tail);
    EXPECT_NEAR(glm::length(glm::vec3(ball->tail) - glm::vec3(ball->point)) * panel.camera.pixelsPerMm(),
                body.length_px, 1e-3);
    body.ball_radius_mm = 0.0;
    const auto point = stylusIn(panel, body);
    EXPECT_EQ(glm::vec3(point->point), glm::vec3(point->ball)) << "without a ball it begins at the tip";
  }
}

}  // namespace
}  // namespace fettle::render
