#include "app/window/flight.h"

#include <cmath>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "app/window/navigation.h"

namespace fettle::app {
namespace {

using render::Framing;
using render::Projection;
using render::View;
using std::chrono::milliseconds;

constexpr Flight::Clock::time_point kStart{};

Framing flightPart() {
  Framing framing;
  framing.shown = {{-50, -40, -6}, {50, 40, 6}};
  framing.drawn = {{-50, -40, -6}, {50, 40, 9}};
  framing.plot = {20, 18, 640, 480};
  framing.share = 0.976;
  return framing;
}

View flightView(double azimuth, double elevation, Projection projection = Projection::kOrthographic) {
  View view;
  view.width = 900;
  view.azimuth_deg = azimuth;
  view.elevation_deg = elevation;
  view.projection = projection;
  return view;
}

TEST(Flight, ends_in_time_exactly_at_its_destination) {
  View view = flightView(350.0, 45.0), to = flightView(10.0, 0.0);
  to.zoom = 7.0;
  to.centre_x = 0.3;
  to.width = 300;  // of another window
  Flight flight;
  EXPECT_FALSE(flight.active());
  flight.begin(view, to, flightPart(), kStart);
  EXPECT_TRUE(flight.active());
  flight.follow(view, kStart + Flight::kTime / 2);
  EXPECT_TRUE(flight.active());
  EXPECT_NEAR(std::remainder(view.azimuth_deg, 360.0), 0.0, 1e-9) << "the short way, over 360";
  flight.follow(view, kStart + Flight::kTime);
  EXPECT_FALSE(flight.active());
  to.width = 900;
  EXPECT_EQ(view, to);
  flight.follow(view = flightView(1.0, 2.0), kStart + 2 * Flight::kTime);
  EXPECT_EQ(view, flightView(1.0, 2.0)) << "over";
}

TEST(Flight, begins_where_the_view_is_and_moves_without_a_jump) {
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    View from = flightView(330.0, 45.0, projection), to = flightView(90.0, 80.0, projection);
    from.zoom = 20.0;
    from.centre_x = 0.2;
    to.zoom = 30.0;
    to.centre_x = 0.8;
    to.centre_z = 0.01;
    const Framing framing = flightPart();
    Flight flight;
    flight.begin(from, to, framing, kStart);
    View view = from, before = from;
    flight.follow(view, kStart);
    EXPECT_NEAR(view.zoom, from.zoom, 1e-6 * from.zoom);
    EXPECT_LT(glm::length(framing.camera(view).target() - framing.camera(from).target()), 1e-6);
    for (int i = 1; i <= 300; ++i) {
      flight.follow(view, kStart + milliseconds(i));
      // What is in the middle of one picture is seen in the next.
      const glm::dvec2 moved =
          framing.camera(view).pixelOf(framing.camera(before).target()) - glm::dvec2(340.0, 258.0);
      EXPECT_LT(glm::length(moved), 40.0) << i;
      EXPECT_LT(std::abs(std::log(view.zoom / before.zoom)), 0.1) << i;
      before = view;
    }
    EXPECT_EQ(view, to);
  }
}

// Otherwise a detail that was zoomed to would leave the picture on the way and come back.
TEST(Flight, about_a_detail_keeps_it_in_the_middle) {
  const Framing framing = flightPart();
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    View from = flightView(330.0, 90.0, projection);
    from.zoom = 40.0;
    const glm::dvec3 detail(21.0, -13.0, 5.0);
    Navigation::centreOn(from, framing, detail);
    View to = from;
    Navigation::lookFrom(to, framing, detail, 90.0, 0.0);
    Flight flight;
    flight.begin(from, to, framing, kStart);
    for (int i = 0; i <= 300; i += 10) {
      View view = from;
      flight.follow(view, kStart + milliseconds(i));
      EXPECT_LT(glm::length(framing.camera(view).pixelOf(detail) - glm::dvec2(340.0, 258.0)), 1e-3) << i;
    }
  }
}

TEST(Flight, from_one_projection_into_the_other_keeps_the_size_at_its_ends) {
  const Framing framing = flightPart();
  const View from = flightView(330.0, 45.0), to = flightView(0.0, 45.0, Projection::kPerspective);
  Flight flight;
  flight.begin(from, to, framing, kStart);
  View view = from;
  flight.follow(view, kStart);
  EXPECT_EQ(view.projection, Projection::kPerspective);
  EXPECT_NEAR(framing.camera(view).pixelsPerMm(), framing.camera(from).pixelsPerMm(), 1e-6);
}

TEST(Flight, does_not_pass_through_another_exaggeration_of_heights) {
  const View from = flightView(330.0, 45.0);
  View to = flightView(0.0, 45.0), view = from;
  to.vertical_exaggeration = 5.0;
  Flight flight;
  flight.begin(from, to, flightPart(), kStart);
  flight.follow(view, kStart);
  EXPECT_EQ(view, to);
  EXPECT_FALSE(flight.active());
}

TEST(ZoomPath, ends_at_both_places_and_at_their_scales) {
  for (const auto& [far, from, to] : {std::tuple{100.0, 3.0, 5.0},
                                      {0.0, 3.0, 900.0},
                                      {1e-9, 2.0, 2.0},
                                      {5.0, 5.0, 5.0},
                                      {1e6, 1e-3, 1e-3},
                                      {2e-6, 1.0, 1.0},
                                      {1.0, 1e4, 1e-2}}) {
    const ZoomPath path(far, from, to);
    EXPECT_NEAR(path.at(0.0).share, 0.0, 1e-9);
    EXPECT_NEAR(path.at(0.0).across, from, 1e-6 * from);
    EXPECT_NEAR(path.at(1.0).share, 1.0, 1e-6) << far << ' ' << from << ' ' << to;
    EXPECT_NEAR(path.at(1.0).across, to, 1e-6 * to) << far << ' ' << from << ' ' << to;
    double before = 0.0;
    for (double way = 0.0; way <= 1.0; way += 1.0 / 64.0) {
      EXPECT_GE(path.at(way).share, before - 1e-12);
      before = path.at(way).share;
    }
  }
  // Far apart, both are seen together on the way.
  EXPECT_GT(ZoomPath(100.0, 1.0, 1.0).at(0.5).across, 50.0);
}

}  // namespace
}  // namespace fettle::app
