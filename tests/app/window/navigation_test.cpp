#include "app/window/navigation.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

namespace fettle::app {
namespace {

using render::Camera;
using render::Framing;
using render::Projection;
using render::View;

constexpr double kNear_px = 1e-6;  // rounding of doubles at the largest zoom, and far below what is seen

Framing framingOf(const glm::dvec3& size, const render::Rectangle& plot = {20, 18, 640, 480}) {
  Framing framing;
  const glm::dvec3 half = 0.5 * size;
  framing.shown = {-half, half};
  framing.drawn = {-half, half + glm::dvec3(0.0, 0.0, half.z)};
  framing.plot = plot;
  framing.share = 0.976;
  return framing;
}

// A part; a strip; a single profile, drawn as two rows; a part far narrower than its plot; a flat one.
std::vector<Framing> framings() {
  return {framingOf({100.0, 80.0, 12.0}),  framingOf({400.0, 2.0, 9.0}),
          framingOf({9999.0, 1.0, 250.0}), framingOf({10.0, 30.0, 3.0}, {0, 0, 1900, 200}),
          framingOf({1e-3, 1e-3, 3e-5}),   framingOf({5e6, 4e6, 2e5}, {0, 22, 60, 900})};
}

View viewAlong(double azimuth, double elevation, Projection projection, double zoom = 1.0) {
  View view;
  view.azimuth_deg = azimuth;
  view.elevation_deg = elevation;
  view.projection = projection;
  view.zoom = zoom;
  return view;
}

void expectAt(const View& view, const Framing& framing, const glm::dvec3& point, const glm::dvec2& pixel) {
  const glm::dvec2 at = framing.camera(view).pixelOf(point);
  EXPECT_NEAR(at.x, pixel.x, kNear_px);
  EXPECT_NEAR(at.y, pixel.y, kNear_px);
}

// Points of the block, of its rim, above it and beside it.
std::vector<glm::dvec3> pointsOf(const Framing& framing) {
  const glm::dvec3 high = framing.shown.high;
  return {{0.0, 0.0, 0.0},
          0.9 * high,
          {-high.x, 0.3 * high.y, high.z},
          {0.2 * high.x, -high.y, -high.z},
          {1.4 * high.x, 0.0, 0.0}};
}

TEST(Navigation, a_turn_leaves_the_point_under_the_hand_at_its_pixel_and_its_size) {
  for (const Framing& framing : framings())
    for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective})
      for (const double zoom : {0.4, 1.0, 37.0})
        for (const glm::dvec3& point : pointsOf(framing)) {
          View view = viewAlong(330.0, 45.0, projection, zoom);
          if (zoom > 2.0) Navigation::centreOn(view, framing, point + 0.01 * framing.longerSide());
          const Camera first = framing.camera(view);
          const glm::dvec2 pixel = first.pixelOf(point);
          const double size = first.pixelsPerMmAt(point);
          for (const auto& [azimuth, elevation] :
               {std::pair{10.0, 0.0}, {100.0, 0.5}, {250.0, 89.0}, {0.0, 90.0}, {77.0, 3.0}, {330.0, 45.0}}) {
            SCOPED_TRACE(testing::Message() << framing.shown.high.x << ' ' << zoom << ' ' << azimuth << ' '
                                            << elevation << ' ' << static_cast<int>(projection));
            Navigation::turnAbout(view, framing, point, azimuth, elevation);
            expectAt(view, framing, point, pixel);
            EXPECT_NEAR(framing.camera(view).pixelsPerMmAt(point), size, 1e-9 * size);
          }
        }
}

TEST(Navigation, a_turn_there_and_back_ends_where_it_began) {
  for (const Framing& framing : framings())
    for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
      const View begun = viewAlong(30.0, 60.0, projection, 3.0);
      View view = begun;
      const glm::dvec3 point = pointsOf(framing)[1];
      for (const double elevation : {30.0, 0.0, 15.0, 90.0, 60.0})
        Navigation::turnAbout(view, framing, point, 30.0 + 2.0 * (elevation - 60.0), elevation);
      EXPECT_NEAR(view.zoom, begun.zoom, 1e-9);
      // In lengths on the screen: along the short side of a profile fractions are any number.
      const glm::dvec3 moved = framing.camera(view).target() - framing.camera(begun).target();
      EXPECT_LT(glm::length(moved) * framing.camera(begun).pixelsPerMm(), 1e-6);
    }
}

TEST(Navigation, a_drag_over_the_whole_picture_is_a_full_turn) {
  const Framing framing = framings()[0];
  View view = viewAlong(20.0, 40.0, Projection::kOrthographic);
  Navigation::turnBy(view, framing, {0, 0, 0}, {320.0, 0.0}, 640.0);
  EXPECT_NEAR(std::remainder(view.azimuth_deg - 200.0, 360.0), 0.0, 1e-9);
  Navigation::turnBy(view, framing, {0, 0, 0}, {320.0, 0.0}, 640.0);
  EXPECT_NEAR(view.azimuth_deg, 20.0, 1e-9);
  Navigation::turnBy(view, framing, {0, 0, 0}, {0.0, -1000.0}, 640.0);
  EXPECT_EQ(view.elevation_deg, 0.0) << "down to the horizon itself";
  Navigation::turnBy(view, framing, {0, 0, 0}, {0.0, 1000.0}, 640.0);
  EXPECT_EQ(view.elevation_deg, 90.0);
}

TEST(Navigation, panning_takes_the_point_along_under_the_cursor) {
  for (const Framing& framing : framings())
    for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective})
      for (const double elevation : {0.0, 5.0, 19.9, 20.0, 45.0, 90.0}) {
        SCOPED_TRACE(testing::Message() << framing.shown.high.x << ' ' << elevation);
        View view = viewAlong(300.0, elevation, projection, 2.0);
        const glm::dvec3 point(0.0, 0.0, 0.2 * framing.shown.high.z);
        glm::dvec2 pixel = framing.camera(view).pixelOf(point);
        for (const glm::dvec2& step : {glm::dvec2(9.0, -4.0), glm::dvec2(-5.0, 6.0), glm::dvec2(0.0, -7.0)}) {
          pixel += step;
          Navigation::put(view, framing, point, pixel);
          expectAt(view, framing, point, pixel);
        }
        EXPECT_EQ(view.zoom, 2.0);
      }
}

TEST(Navigation, panning_ends_half_a_field_beyond_it_and_never_moves_the_view_back) {
  const Framing framing = framingOf({100.0, 80.0, 12.0});
  for (const double elevation : {0.0, 30.0, 90.0}) {
    View view = viewAlong(0.0, elevation, Projection::kOrthographic);
    for (int i = 0; i < 20; ++i) Navigation::put(view, framing, {0, 0, 0}, {340.0 - 400.0 * i, 258.0});
    EXPECT_NEAR(view.centre_x, 1.5, 1e-12);
  }
  // Farther away already, by a turn about a point at the rim of a wide picture.
  View view = viewAlong(0.0, 90.0, Projection::kOrthographic, 0.1);
  view.centre_x = 4.0;
  const glm::dvec3 point(0, 0, 0);
  const glm::dvec2 pixel = framing.camera(view).pixelOf(point);
  Navigation::put(view, framing, point, pixel);
  EXPECT_NEAR(view.centre_x, 4.0, 1e-12);
  Navigation::put(view, framing, point, pixel + glm::dvec2(-50.0, 0.0));
  EXPECT_NEAR(view.centre_x, 4.0, 1e-12) << "no farther";
  Navigation::put(view, framing, point, pixel + glm::dvec2(10.0, 0.0));
  EXPECT_LT(view.centre_x, 4.0) << "back";
}

TEST(Navigation, zooming_leaves_the_point_under_the_cursor_where_it_is) {
  for (const Framing& framing : framings())
    for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective})
      for (const double elevation : {0.0, 10.0, 35.0, 90.0}) {
        SCOPED_TRACE(testing::Message() << framing.shown.high.x << ' ' << elevation);
        View view = viewAlong(200.0, elevation, projection);
        const glm::dvec3 point(0.3 * framing.shown.high.x, -0.2 * framing.shown.high.y,
                               0.5 * framing.shown.high.z);
        const glm::dvec2 pixel = framing.camera(view).pixelOf(point);
        for (const double steps : {1.0, 5.0, 20.0, -3.0, -10.0}) {
          Navigation::zoomAt(view, framing, point, steps);
          expectAt(view, framing, point, pixel);
        }
        EXPECT_NEAR(view.zoom, std::pow(1.15, 13.0), 1e-9);
      }
}

TEST(Navigation, zoom_ends_at_its_limits_and_does_not_jump_to_them) {
  const Framing framing = framings()[0];
  View view = viewAlong(200.0, 40.0, Projection::kOrthographic);
  Navigation::zoomAt(view, framing, {0, 0, 0}, 1000.0);
  EXPECT_EQ(view.zoom, Navigation::kLargestZoom);
  Navigation::zoomAt(view, framing, {0, 0, 0}, -2000.0);
  EXPECT_EQ(view.zoom, Navigation::kSmallestZoom);
  view.zoom = 0.01;  // by a turn
  Navigation::zoomAt(view, framing, {0, 0, 0}, -1.0);
  EXPECT_EQ(view.zoom, 0.01);
  Navigation::zoomAt(view, framing, {0, 0, 0}, 1.0);
  EXPECT_NEAR(view.zoom, 0.0115, 1e-12);
}

// A hand that does whatever it likes, in both projections: the picture can always be drawn (render/plan checks the
// view), and the block never gets behind the viewer.
TEST(Navigation, any_sequence_of_movements_leads_to_a_view_that_can_be_drawn) {
  std::mt19937 random(7);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (const Framing& framing : framings())
    for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
      View view = viewAlong(330.0, 45.0, projection);
      for (int i = 0; i < 2000; ++i) {
        const glm::dvec3 high = framing.shown.high;
        const glm::dvec3 point = high * glm::dvec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
        const Camera camera = framing.camera(view);
        if (!(camera.pixelsPerMmAt(point) > 0.0)) continue;
        const glm::dvec2 at = camera.pixelOf(point);
        // What is seen is taken hold of.
        if (std::abs(at.x - 300.0) > 1000.0 || std::abs(at.y - 300.0) > 1000.0) {
          if (i % 50 == 0) Navigation::centreOn(view, framing, point);
          continue;
        }
        switch (i % 3) {
          case 0:
            Navigation::turnBy(view, framing, point, {uniform(-300, 300), uniform(-300, 300)}, 640.0);
            break;
          case 1:
            Navigation::put(view, framing, point, at + glm::dvec2(uniform(-100, 100), uniform(-100, 100)));
            break;
          default:
            Navigation::zoomAt(view, framing, point, uniform(-6, 6));
        }
        ASSERT_TRUE(view.zoom >= 1e-3 && view.zoom <= 1e6) << i;
        ASSERT_TRUE(view.elevation_deg >= 0.0 && view.elevation_deg <= 90.0) << i;
        const glm::dvec3 from_middle = framing.camera(view).target() - framing.middle();
        ASSERT_LT(glm::length(from_middle), 100.0 * framing.longerSide()) << i;
      }
    }
}

TEST(Navigation, a_side_view_shows_all_of_the_field_where_all_was_seen) {
  const Framing framing = framingOf({400.0, 20.0, 9.0});
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    View view = viewAlong(330.0, 45.0, projection);
    EXPECT_TRUE(Navigation::seesAll(view, framing));
    for (const auto& [azimuth, elevation] :
         {std::pair{0.0, 0.0}, {90.0, 0.0}, {180.0, 0.0}, {270.0, 0.0}, {0.0, 90.0}}) {
      Navigation::lookFrom(view, framing, {30.0, 4.0, 2.0}, azimuth, elevation);
      EXPECT_EQ(std::remainder(view.azimuth_deg - azimuth, 360.0), 0.0);
      EXPECT_EQ(view.elevation_deg, elevation);
      EXPECT_EQ(view.zoom, 1.0);
      EXPECT_EQ(view.centre_z, 0.0);
      EXPECT_TRUE(Navigation::seesAll(view, framing));
    }
  }
}

TEST(Navigation, a_side_view_of_a_detail_shows_the_detail) {
  const Framing framing = framings()[0];
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    View view = viewAlong(330.0, 45.0, projection, 20.0);
    const glm::dvec3 detail(20.0, -13.0, 5.0);
    Navigation::centreOn(view, framing, detail);
    EXPECT_FALSE(Navigation::seesAll(view, framing));
    const double size = framing.camera(view).pixelsPerMmAt(detail);
    for (const auto& [azimuth, elevation] : {std::pair{0.0, 0.0}, {90.0, 0.0}, {0.0, 90.0}, {180.0, 0.0}}) {
      Navigation::lookFrom(view, framing, detail, azimuth, elevation);
      expectAt(view, framing, detail, {20 + 320, 18 + 240});
      EXPECT_NEAR(framing.camera(view).pixelsPerMmAt(detail), size, 1e-9 * size);
    }
  }
}

// From the side, exactly: the top of the block is one line, x runs right, heights run up.
TEST(Navigation, from_the_side_a_plane_is_a_line) {
  const Framing framing = framings()[0];
  View view = viewAlong(330.0, 45.0, Projection::kOrthographic);
  Navigation::lookFrom(view, framing, {0, 0, 0}, 0.0, 0.0);
  const Camera camera = framing.camera(view);
  const glm::dvec2 front = camera.pixelOf({7.0, -40.0, 3.0}), back = camera.pixelOf({7.0, 40.0, 3.0});
  EXPECT_EQ(front, back);
  EXPECT_GT(camera.pixelOf({8.0, 0.0, 3.0}).x, front.x);
  EXPECT_LT(camera.pixelOf({7.0, 0.0, 4.0}).y, front.y);
  EXPECT_EQ(camera.pixelOf({8.0, 0.0, 3.0}).y, front.y);
}

TEST(Navigation, a_place_is_shown_in_the_middle_at_a_third_of_the_picture) {
  const Framing framing = framings()[0];
  View view = viewAlong(10.0, 30.0, Projection::kOrthographic, 2.0);
  Navigation::show(view, framing, {-30.0, 22.0, 4.0}, 10.0);
  expectAt(view, framing, {-30.0, 22.0, 4.0}, {340.0, 258.0});
  EXPECT_NEAR(view.zoom, 100.0 / 30.0, 1e-12);
}

}  // namespace
}  // namespace fettle::app
