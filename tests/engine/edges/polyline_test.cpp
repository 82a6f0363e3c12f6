#include "engine/edges/polyline.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace fettle::engine {
namespace {

std::vector<glm::dvec2> circle(double radius, int points) {
  std::vector<glm::dvec2> all;
  for (int i = 0; i < points; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / points;
    all.emplace_back(40.0 + radius * std::cos(angle), 40.0 + radius * std::sin(angle));
  }
  return all;
}

TEST(Polyline, ResamplesToOneSampleAndKeepsBothEnds) {
  const Polyline line = polylineOf({{1.0, 2.0}, {1.0, 2.0}, {4.0, 6.0}, {4.0, 16.3}}, false);
  EXPECT_EQ(line.size(), 16);  // 15.3 samples long
  EXPECT_EQ(line.points.front(), glm::dvec2(1.0, 2.0));
  EXPECT_NEAR(line.points.back().y, 16.3, 1e-12);
  for (int i = 1; i < line.size(); ++i) {
    const glm::dvec2 run =
        line.points[static_cast<std::size_t>(i)] - line.points[static_cast<std::size_t>(i) - 1];
    EXPECT_NEAR(std::hypot(run.x, run.y), 15.3 / 15.0, 0.3) << i;  // shorter across the corner
  }
}

TEST(Polyline, ClosedLineDoesNotRepeatItsFirstPointAndItsOriginsGoOnceAround) {
  const Polyline line = polylineOf(circle(20.0, 31), true);
  EXPECT_TRUE(line.closed);
  EXPECT_NEAR(line.size(), 2.0 * std::numbers::pi * 20.0, 2.0);
  Polyline moved = line;
  for (glm::dvec2& p : moved.points) p = glm::dvec2(40.0) + (p - glm::dvec2(40.0)) * 0.8;
  const Polyline again = resampled(moved);
  EXPECT_NEAR(again.size(), 0.8 * line.size(), 1.0);
  for (std::size_t i = 1; i < again.origins.size(); ++i) EXPECT_GT(again.origins[i], again.origins[i - 1]);
  EXPECT_LT(again.origins.back(), line.period);
  // The origin of a point is where it was before: 20 / 16 farther out.
  for (std::size_t i = 0; i < again.points.size(); ++i) {
    const glm::dvec2 from = pointAt(line, again.origins[i]), to = again.points[i];
    EXPECT_NEAR(std::hypot(from.x - 40.0, from.y - 40.0) * 0.8, std::hypot(to.x - 40.0, to.y - 40.0), 1e-9);
  }
}

TEST(Polyline, DegenerateStrokes) {
  EXPECT_EQ(polylineOf({}, false).size(), 0);
  EXPECT_EQ(polylineOf({}, true).size(), 0);
  EXPECT_EQ(polylineOf({{3.0, 4.0}}, false).size(), 1);
  EXPECT_EQ(polylineOf({{3.0, 4.0}}, true).size(), 1);
  EXPECT_EQ(polylineOf({{3.0, 4.0}, {3.0, 4.0}}, true).size(), 1);
  const Polyline small = polylineOf({{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}, true);
  EXPECT_FALSE(small.closed) << "a closed line must be long enough for strips";
}

TEST(Polyline, SmoothingKeepsStraightLinesAndEnds) {
  Polyline line = polylineOf({{0.0, 0.0}, {30.0, 15.0}}, false);
  const std::vector<glm::dvec2> smooth = smoothed(line, 2.0);
  for (std::size_t i = 0; i < smooth.size(); ++i) {
    EXPECT_NEAR(smooth[i].x, line.points[i].x, 1e-12);
    EXPECT_NEAR(smooth[i].y, line.points[i].y, 1e-12);
  }
  line.points[10].y += 1.0;  // a lone error: what remains of it is the weight at the centre
  double weight = 0.0;
  for (int k = -6; k <= 6; ++k) weight += std::exp(-0.125 * k * k);
  EXPECT_NEAR(smoothed(line, 2.0)[10].y - smooth[10].y, 1.0 / weight, 1e-12);
}

TEST(Polyline, TangentsFollowTheLine) {
  const Polyline line = polylineOf(circle(20.0, 200), true);
  const std::vector<glm::dvec2> tangents = tangentsOf(line, 3);
  for (int i = 0; i < line.size(); ++i) {
    const glm::dvec2 out = (line.points[static_cast<std::size_t>(i)] - glm::dvec2(40.0)) / 20.0;
    const glm::dvec2 t = tangents[static_cast<std::size_t>(i)];
    EXPECT_NEAR(out.x * t.y - out.y * t.x, 1.0, 1e-3) << "counter-clockwise";
  }
  EXPECT_EQ(tangentsOf(polylineOf({{1.0, 1.0}}, false), 3)[0], glm::dvec2(1.0, 0.0));
}

TEST(Polyline, CountsStepsTheShorterWay) {
  const Polyline ring = polylineOf(circle(20.0, 200), true);
  EXPECT_EQ(ring.stepsBetween(1, ring.size() - 2), 3);
  EXPECT_EQ(ring.wrapped(-1), ring.size() - 1);
  EXPECT_EQ(ring.wrapped(ring.size()), 0);
  const Polyline open = polylineOf({{0.0, 0.0}, {30.0, 0.0}}, false);
  EXPECT_EQ(open.wrapped(-1), -1);
  EXPECT_EQ(open.wrapped(31), -1);
}

}  // namespace
}  // namespace fettle::engine
