#include "render/plan/camera.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

namespace fettle::render {
namespace {

const Box kBox{{-30, -20, -4}, {30, 20, 6}};
const Rectangle kPlot{100, 50, 640, 480};

View viewOf(double azimuth, double elevation, Projection projection = Projection::kOrthographic) {
  View view;
  view.azimuth_deg = azimuth;
  view.elevation_deg = elevation;
  view.projection = projection;
  return view;
}

TEST(Camera, FromAboveXRunsRightAndYRunsUpThePicture) {
  const Camera camera = Camera::fit(viewOf(0, 90), kBox, kBox, kPlot);
  const glm::dvec2 o = camera.pixelOf({0, 0, 1});
  EXPECT_NEAR(o.x, 100 + 320, 1e-9);
  EXPECT_NEAR(o.y, 50 + 240, 1e-9);
  const glm::dvec2 x = camera.pixelOf({10, 0, 1}) - o, y = camera.pixelOf({0, 10, 1}) - o;
  EXPECT_NEAR(x.x, 10 * camera.pixelsPerMm(), 1e-9);
  EXPECT_NEAR(x.y, 0, 1e-9);
  EXPECT_NEAR(y.x, 0, 1e-9);
  EXPECT_NEAR(y.y, -10 * camera.pixelsPerMm(), 1e-9);
}

// The twin: rotate by the azimuth about z, tilt by the elevation, scale. Written out by hand, no matrix.
TEST(Camera, OrthographicPixelsEqualTheRotationWrittenOut) {
  for (const double a : {0.0, 30.0, 315.0, -100.0})
    for (const double e : {5.0, 45.0, 90.0}) {
      const Camera camera = Camera::fit(viewOf(a, e), kBox, kBox, kPlot);
      const double ar = a * std::numbers::pi / 180, er = e * std::numbers::pi / 180;
      const glm::dvec3 middle{0, 0, 1};
      for (const glm::dvec3& p : corners(kBox)) {
        const glm::dvec3 d = p - middle;
        const double along = d.x * std::cos(ar) + d.y * std::sin(ar);
        const double deep = -d.x * std::sin(ar) + d.y * std::cos(ar);  // away from the viewer, level
        const double up = deep * std::sin(er) + d.z * std::cos(er);
        const glm::dvec2 pixel = camera.pixelOf(p);
        EXPECT_NEAR(pixel.x, 420 + along * camera.pixelsPerMm(), 1e-6);
        EXPECT_NEAR(pixel.y, 290 - up * camera.pixelsPerMm(), 1e-6);
      }
    }
}

// Of a headset: its eyes see farther to their own side than to the other, and farther down than up.
TEST(Camera, AnEyesPixelsAreTheTangentsOfWhatItSeesBetweenThoseOfItsEdges) {
  EyeView eye;
  eye.position = {1.0, -40.0, 9.0};
  eye.axes.right = {1.0, 0.0, 0.0};
  eye.axes.up = {0.0, 0.6, 0.8};
  eye.axes.to_viewer = {0.0, -0.8, 0.6};
  eye.left = -1.3, eye.right = 0.9, eye.down = -1.1, eye.up = 0.8;
  const Camera camera = Camera::ofEye(eye, kBox, kPlot);
  for (const glm::dvec3& p : corners(kBox)) {
    const glm::dvec3 d = p - eye.position;
    const double ahead = -glm::dot(eye.axes.to_viewer, d);
    ASSERT_GT(ahead, 0.0);
    const double x = glm::dot(eye.axes.right, d) / ahead, y = glm::dot(eye.axes.up, d) / ahead;
    const glm::dvec2 pixel = camera.pixelOf(p);
    EXPECT_NEAR(pixel.x, kPlot.x + kPlot.width * (x - eye.left) / (eye.right - eye.left), 1e-6);
    EXPECT_NEAR(pixel.y, kPlot.y + kPlot.height * (eye.up - y) / (eye.up - eye.down), 1e-6);
  }
  const double middle = -glm::dot(eye.axes.to_viewer, 0.5 * (kBox.low + kBox.high) - eye.position);
  EXPECT_NEAR(camera.distance(), middle, 1e-9);
  EXPECT_NEAR(camera.pixelsPerMm() * middle, std::max(kPlot.width / 2.2, kPlot.height / 1.9), 1e-6);
}

TEST(Camera, EveryCornerOfTheBoxLiesInThePlotAndTouchesItsRim) {
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective})
    for (const double a : {0.0, 45.0, 200.0})
      for (const double e : {10.0, 60.0, 90.0}) {
        const Camera camera = Camera::fit(viewOf(a, e, projection), kBox, kBox, kPlot);
        double gap = 1e9;
        for (const glm::dvec3& p : corners(kBox)) {
          const glm::dvec2 px = camera.pixelOf(p);
          for (const double g : {px.x - 100, 740 - px.x, px.y - 50, 530 - px.y}) {
            EXPECT_GE(g, -1e-6) << a << ' ' << e;
            gap = std::min(gap, g);
          }
        }
        EXPECT_LT(gap, 1e-6) << a << ' ' << e;
      }
}

TEST(Camera, TheRayUnderAPixelGoesThroughThePointThatLandsThere) {
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    View view = viewOf(320, 35, projection);
    view.zoom = 3;
    view.centre_x = 0.2;
    const Camera camera = Camera::fit(view, kBox, kBox, kPlot);
    for (const glm::dvec3& p : corners(kBox)) {
      const Ray ray = camera.rayAt(camera.pixelOf(p));
      EXPECT_NEAR(glm::length(glm::cross(p - ray.from, ray.along)), 0.0, 1e-8);
      EXPECT_NEAR(glm::length(ray.along), 1.0, 1e-12);
      EXPECT_LT(glm::dot(ray.along, camera.toViewer()), 0.0);
    }
  }
}

TEST(Camera, DepthOfEverythingDrawnLiesBetweenThePlanes) {
  const Box tall{{-30, -20, -40}, {30, 20, 300}};
  for (const double e : {10.0, 90.0}) {
    const Camera camera = Camera::fit(viewOf(315, e), kBox, tall, kPlot);
    for (const glm::dvec3& p : corners(tall)) {
      const glm::dvec4 clip = camera.clipFromScene() * glm::dvec4(p, 1);
      EXPECT_GT(clip.z / clip.w, 0.0);
      EXPECT_LT(clip.z / clip.w, 1.0);
    }
  }
}

TEST(Camera, MissesOnlyWhatIsOutsideThePlot) {
  View view = viewOf(0, 90);
  view.zoom = 10;
  const Camera camera = Camera::fit(view, kBox, kBox, kPlot);
  EXPECT_FALSE(camera.misses({{-1, -1, 0}, {1, 1, 1}}));
  EXPECT_FALSE(camera.misses(kBox));
  EXPECT_TRUE(camera.misses({{20, 10, 0}, {30, 20, 1}}));
}

TEST(Camera, APartOfThePictureSeesItsPointsAtTheirPixelsAndEndsWhereItDoes) {
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    const Camera whole = Camera::fit(viewOf(320, 35, projection), kBox, kBox, kPlot);
    const Rectangle rectangle{300, 90, 64, 50};
    const Camera part = whole.part(rectangle);
    for (const glm::dvec3& p : corners(kBox)) {
      EXPECT_NEAR(glm::length(part.pixelOf(p) - whole.pixelOf(p)), 0.0, 1e-9);
      const Ray ray = part.rayAt(whole.pixelOf(p));
      EXPECT_NEAR(glm::length(glm::cross(p - ray.from, ray.along)), 0.0, 1e-8);
    }
    const Ray inside = whole.rayAt({332, 115}), outside = whole.rayAt({290, 115});
    const auto point = [](const Ray& ray) { return Box{ray.from + ray.along, ray.from + ray.along}; };
    EXPECT_FALSE(part.misses(point(inside)));
    EXPECT_TRUE(part.misses(point(outside)));
    EXPECT_FALSE(whole.misses(point(outside)));
    EXPECT_NEAR(part.asidePixels(1.0), whole.asidePixels(1.0), 1e-9);
  }
}

TEST(Camera, ABoxWithoutExtentStillHasAFinitePicture) {
  const Box point{{0, 0, 0}, {0, 0, 0}};
  for (const Projection projection : {Projection::kOrthographic, Projection::kPerspective}) {
    const glm::dvec2 px = Camera::fit(viewOf(315, 45, projection), point, point, kPlot).pixelOf({0, 0, 0});
    EXPECT_NEAR(px.x, 420, 1e-6);
    EXPECT_NEAR(px.y, 290, 1e-6);
  }
}

}  // namespace
}  // namespace fettle::render
