// A picture for each eye: where things lie in them, and that they are drawn as such.
#include "render/stereo.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <glm/geometric.hpp>

#include "engine/field/live_field.h"
#include "render/live_picture.h"
#include "tests/render/fields.h"

namespace fettle::render {
namespace {

const Box kShown{{-40, -30, -5}, {40, 30, 5}};
const Rectangle kPlot{10, 20, 640, 400};

Camera cameraOf(Projection projection, double azimuth, double elevation, double zoom) {
  View view;
  view.projection = projection;
  view.azimuth_deg = azimuth;
  view.elevation_deg = elevation;
  view.zoom = zoom;
  view.centre_x = 0.6;
  return Camera::fit(view, kShown, kShown, kPlot);
}

class Points {
 public:
  glm::dvec3 next() {
    const auto in = [this](double low, double high) {
      return low + (high - low) * std::generate_canonical<double, 32>(random_);
    };
    const double x = in(-40, 40), y = in(-30, 30);
    return {x, y, in(-5, 5)};
  }

 private:
  std::mt19937 random_{7};
};

// Where two lines come nearest to each other: the middle between them, and how far apart they are.
std::pair<glm::dvec3, double> meeting(const Ray& a, const Ray& b) {
  const glm::dvec3 w = a.from - b.from;
  const double ab = glm::dot(a.along, b.along), s = 1.0 - ab * ab;
  const double ta = (ab * glm::dot(b.along, w) - glm::dot(a.along, w)) / s;
  const double tb = (glm::dot(b.along, w) - ab * glm::dot(a.along, w)) / s;
  const glm::dvec3 p = a.from + ta * a.along, q = b.from + tb * b.along;
  return {0.5 * (p + q), glm::length(p - q)};
}

TEST(StereoCamera, PointsOfTheWindowAreSeenAtOnePlaceNearOnesCrossedFarOnesApart) {
  for (const Projection projection : {Projection::kPerspective, Projection::kOrthographic})
    for (const double window : {0.8, 1.0, 1.3}) {
      const Camera middle = cameraOf(projection, 30, 35, 1.5);
      const std::array<Camera, 2> eyes = eyesOf(middle, {}, window);
      Points points;
      for (int i = 0; i < 200; ++i) {
        const glm::dvec3 p = points.next();
        const double at = middle.windowOf(p);
        // No point is higher for one eye than for the other, wherever it is.
        ASSERT_NEAR(eyes[0].pixelOf(p).y, eyes[1].pixelOf(p).y, 1e-9);
        ASSERT_NEAR(eyes[0].pixelOf(p).y, middle.pixelOf(p).y, 1e-9);
        if (std::abs(at - window) > 1e-3) {
          ASSERT_EQ(parallaxOf(eyes, p) > 0.0, at > window) << at;
        }
        // The same point moved onto the window along the view.
        const glm::dvec3 on =
            p + (at - window) * (middle.toViewer() / (at - middle.windowOf(p + middle.toViewer())));
        ASSERT_NEAR(middle.windowOf(on), window, 1e-12);
        ASSERT_NEAR(parallaxOf(eyes, on), 0.0, 1e-9);
        ASSERT_NEAR(eyes[0].pixelOf(on).x, middle.pixelOf(on).x, 1e-9);
      }
    }
}

TEST(StereoCamera, AnEyeSeesAPointWhereItsLineOfSightCrossesTheWindow) {
  const Camera middle = cameraOf(Projection::kPerspective, 300, 50, 2.0);
  const double window = 1.1, share = 0.04;
  const Camera eye = middle.aside(share, window);
  // Every ray of the middle camera comes from where the viewer is; the eye is that, aside.
  const glm::dvec3 viewer = meeting(middle.rayAt({100, 50}), middle.rayAt({500, 380})).first;
  const double distance = 1.0 / (middle.windowOf(glm::dvec3(0.0)) - middle.windowOf(middle.toViewer()));
  const glm::dvec3 place = viewer + share * distance * middle.right();
  EXPECT_NEAR(middle.windowOf(viewer), 0.0, 1e-9);
  Points points;
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 p = points.next();
    const double t = window / middle.windowOf(p);  // from the eye, at 0, to p
    const glm::dvec3 crossing = place + t * (p - place);
    const glm::dvec2 expected = middle.pixelOf(crossing), seen = eye.pixelOf(p);
    // Rounding: coordinates of some 1000 px, a few hundred operations at 1e-16.
    ASSERT_NEAR(seen.x, expected.x, 1e-8);
    ASSERT_NEAR(seen.y, expected.y, 1e-8);
  }
}

TEST(StereoCamera, TheTwoEyesLinesOfSightMeetAtThePointTheyShow) {
  for (const Projection projection : {Projection::kPerspective, Projection::kOrthographic}) {
    const std::array<Camera, 2> eyes = eyesOf(cameraOf(projection, 120, 40, 1.0), {}, 1.0);
    Points points;
    for (int i = 0; i < 100; ++i) {
      const glm::dvec3 p = points.next();
      const auto [at, apart] = meeting(eyes[0].rayAt(eyes[0].pixelOf(p)), eyes[1].rayAt(eyes[1].pixelOf(p)));
      // The lines meet at a thirtieth of a radian, so that rounding is some thirty times larger along them.
      ASSERT_NEAR(glm::length(at - p), 0.0, 1e-7);
      ASSERT_NEAR(apart, 0.0, 1e-9);
    }
  }
}

TEST(StereoCamera, MillimetresOnTheScreenAreWhatFarPointsAreApart) {
  const Camera middle = cameraOf(Projection::kPerspective, 0, 20, 1.0);
  Stereo stereo;
  stereo.eye_separation_mm = 63.0;
  stereo.mm_per_pixel = 0.3;
  const std::array<Camera, 2> eyes = eyesOf(middle, stereo, 1.2);
  const glm::dvec3 far = -1e9 * middle.toViewer();
  EXPECT_NEAR(parallaxOf(eyes, far), 63.0 / 0.3, 1e-3);
}

TEST(StereoCamera, WhatAMoveShowsStaysWithinTheBoundForBothEyes) {
  for (const Projection projection : {Projection::kPerspective, Projection::kOrthographic}) {
    const std::array<Camera, 2> eyes = eyesOf(cameraOf(projection, 75, 25, 3.0), {}, 0.9);
    Points points;
    for (int i = 0; i < 300; ++i) {
      const glm::dvec3 low = points.next(), step = 0.02 * points.next();
      const Box box{low, low + glm::dvec3(1.0)};
      for (const Camera& eye : eyes) {
        const glm::dvec2 a = eye.pixelOf(low + glm::dvec3(0.5)),
                         b = eye.pixelOf(low + glm::dvec3(0.5) + step);
        // What is outside the plot has no bound.
        if (std::abs(a.x - 330) > 320 || std::abs(a.y - 220) > 200) continue;
        ASSERT_LE(glm::length(b - a), eye.movesAtMost(step, box) * (1.0 + 1e-9));
      }
    }
  }
}

TEST(StereoCamera, ValuesOutOfRangeAreRefused) {
  EXPECT_TRUE(check(Stereo{}));
  const auto refused = [](auto change) {
    Stereo stereo;
    change(stereo);
    const engine::Status status = check(stereo);
    return !status && status.error().kind == engine::ErrorKind::kInput;
  };
  EXPECT_TRUE(refused([](Stereo& s) { s.eye_separation = 0.0; }));
  EXPECT_TRUE(refused([](Stereo& s) { s.eye_separation = std::nan(""); }));
  EXPECT_TRUE(refused([](Stereo& s) { s.eye_separation_mm = -1.0; }));
  EXPECT_TRUE(refused([](Stereo& s) { s.mm_per_pixel = 0.0; }));
  EXPECT_TRUE(refused([](Stereo& s) { s.screen_distance = 0.01; }));
}

}  // namespace
}  // namespace fettle::render
