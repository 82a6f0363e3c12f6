// What a hand takes hold of: LivePicture::grip without a device.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "render/live/live_plan.h"
#include "tests/render/support/fields.h"

namespace fettle::render {
namespace {

PanelPlan panelOf(const engine::Version& field, const View& view) {
  const std::vector<engine::Version> fields{field};
  PictureSpec spec;
  spec.view = view;
  auto plan = planPicture(spec, fields, spansOf(fields, {}), layOut(view, spec.decoration, 1, Titles::kNone));
  if (!plan) throw std::runtime_error(plan.error().line());
  return plan->panels.front();
}

View viewFrom(double azimuth, double elevation, Projection projection = Projection::kOrthographic) {
  View view;
  view.width = 800;
  view.height = 600;
  view.azimuth_deg = azimuth;
  view.elevation_deg = elevation;
  view.projection = projection;
  return view;
}

double wave(int c, int r) {
  return 3.0 * std::sin(0.1 * c) * std::cos(0.13 * r);
}

// Far from the origin of heights, as a part of a survey is; a hole in the middle.
engine::Version holed(double lift = 5e6) {
  return fieldOf(gridOf(120, 90, 0.5, 0.5), [lift](int c, int r) {
    return std::hypot(c - 60.0, r - 45.0) < 12.0 ? double{kNan} : lift + wave(c, r);
  });
}

TEST(Grip, holds_the_surface_that_is_seen_there) {
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective})
    for (const double elevation : {90.0, 45.0, 4.0}) {
      const PanelPlan panel = panelOf(holed(), viewFrom(330.0, elevation, projection));
      int surfaces = 0;
      for (int y = 40; y < 560; y += 40)
        for (int x = 40; x < 680; x += 40) {
          const Ray ray = panel.camera.rayAt({x, y});
          const Grip grip = gripOf(panel, ray);
          const glm::dvec2 at = panel.camera.pixelOf(grip.point);
          EXPECT_NEAR(at.x, x, 1e-6);
          EXPECT_NEAR(at.y, y, 1e-6);
          EXPECT_EQ(panel.camera.pixelOf(grip.point),
                    grip.framing.camera(viewFrom(330.0, elevation, projection)).pixelOf(grip.point));
          surfaces += grip.on_surface;
        }
      EXPECT_GT(surfaces, 10) << elevation;
    }
}

TEST(Grip, holds_the_side_of_the_block_below_its_rim) {
  const PanelPlan panel = panelOf(holed(0.0), viewFrom(0.0, 0.0));
  // Just below the lowest place of the front rim: nothing but the block's side is there.
  const glm::dvec3 rim = inScene(panel, {30.0, 0.0, -2.9});
  const Grip grip = gripOf(panel, panel.camera.rayAt(panel.camera.pixelOf(rim - glm::dvec3(0.0, 0.0, 0.5))));
  EXPECT_TRUE(grip.on_surface);
  EXPECT_NEAR(grip.point.y, panel.framing.shown.low.y, 1e-9);
}

TEST(Grip, over_a_hole_holds_the_plane_at_half_the_relief) {
  const PanelPlan panel = panelOf(holed(), viewFrom(0.0, 90.0));
  const Grip grip = gripOf(panel, panel.camera.rayAt(panel.camera.pixelOf({0.0, 0.0, 0.0})));
  EXPECT_FALSE(grip.on_surface);
  EXPECT_NEAR(glm::length(grip.point), 0.0, 1e-9);
}

TEST(Grip, beside_the_field_holds_what_is_as_far_away_as_its_middle) {
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective})
    for (const double elevation : {0.0, 30.0, 90.0}) {
      const PanelPlan panel = panelOf(holed(), viewFrom(45.0, elevation, projection));
      for (const glm::dvec2& pixel :
           {glm::dvec2(1, 1), glm::dvec2(700, 1), glm::dvec2(1, 590), glm::dvec2(5000, -9000)}) {
        const Grip grip = gripOf(panel, panel.camera.rayAt(pixel));
        EXPECT_FALSE(grip.on_surface);
        EXPECT_NEAR(glm::dot(panel.camera.toViewer(), grip.point - panel.framing.middle()), 0.0, 1e-6);
        EXPECT_NEAR(glm::length(panel.camera.pixelOf(grip.point) - pixel), 0.0, 1e-6);
      }
    }
}

TEST(Grip, of_a_single_profile_and_of_nothing_but_holes_is_there_too) {
  for (const engine::Version& field : {fieldOf(gridOf(500, 1), [](int c, int) { return wave(c, 0); }),
                                       fieldOf(gridOf(1, 40), [](int, int r) { return wave(0, r); }),
                                       fieldOf(gridOf(1, 1), [](int, int) { return 4.0; }),
                                       fieldOf(gridOf(30, 30), [](int, int) { return double{kNan}; })})
    for (const double elevation : {0.0, 30.0, 90.0}) {
      const PanelPlan panel = panelOf(field, viewFrom(330.0, elevation));
      for (const glm::dvec2& pixel : {glm::dvec2(340, 270), glm::dvec2(30, 30)}) {
        const Grip grip = gripOf(panel, panel.camera.rayAt(pixel));
        EXPECT_NEAR(glm::length(panel.camera.pixelOf(grip.point) - pixel), 0.0, 1e-6);
      }
    }
}

TEST(Framing, a_point_of_the_field_is_where_the_panel_draws_it) {
  const PanelPlan panel = panelOf(holed(), viewFrom(20.0, 40.0));
  const glm::dvec3 point(7.5, 11.0, 5e6 + 2.0);
  EXPECT_LT(glm::length(panel.framing.sceneOf(point) - inScene(panel, point)), 1e-8);
}

TEST(Framing, aims_at_a_point_at_any_height) {
  for (const double elevation : {0.0, 30.0, 90.0}) {
    View view = viewFrom(20.0, elevation);
    const PanelPlan panel = panelOf(holed(), view);
    const glm::dvec3 point(7.0, -3.0, 4.0);
    panel.framing.aimAt(point, view);
    EXPECT_LT(glm::length(panel.framing.camera(view).target() - point), 1e-9);
    const Rectangle& plot = panel.framing.plot;
    EXPECT_NEAR(panel.framing.camera(view).pixelOf(point).y, plot.y + 0.5 * plot.height, 1e-9);
  }
}

}  // namespace
}  // namespace fettle::render
