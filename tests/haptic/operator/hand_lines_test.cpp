#include "haptic/operator/hand_lines.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "engine/scanner/true_lines.h"

namespace fettle::haptic {
namespace {

engine::Edge longEdge() {
  engine::Edge edge;
  for (int i = 0; i <= 20000; ++i) edge.points_mm.emplace_back(0.1 * i, 0.0);
  return edge;
}

engine::Grid tenthGrid() {
  engine::Grid grid;
  grid.width = grid.height = 1000;
  grid.spacing_x = 0.1;
  grid.spacing_y = 0.2;
  return grid;
}

TEST(HandLines, AreAsFarFromTheEdgeAsThePersonIs) {
  const engine::Edge edge = longEdge();
  const auto lines = handLines({&edge, 1}, tenthGrid(), OperatorSpec{});
  ASSERT_EQ(lines.size(), 1U);
  ASSERT_EQ(lines[0].points.size(), edge.points_mm.size());
  double squares = 0.0;
  for (const glm::dvec2& p : lines[0].points) squares += std::pow(0.2 * p.y, 2);
  // 100 s of a motion of whole sines: 0.133 mm, off by the few sines that are slow.
  EXPECT_NEAR(std::sqrt(squares / 20001.0), std::hypot(0.124, 0.049), 0.02);
}

// A hand's motion is one of time: who draws twice as fast has gone twice as far when it is at the same deviation.
TEST(HandLines, OfAFasterHandHaveTheSameMotionDrawnOut) {
  const engine::Edge edge = longEdge();
  OperatorSpec slow, fast;
  fast.speed_mm_s = 2.0 * slow.speed_mm_s;
  const std::vector<HandLine> a = handLines({&edge, 1}, tenthGrid(), slow);
  const std::vector<HandLine> b = handLines({&edge, 1}, tenthGrid(), fast);
  double most = 0.0;
  for (std::size_t i = 0; 2 * i < b[0].points.size(); ++i) {
    // Sums of 0.1 mm that end within 1e-9 mm of each other, and a hand slower than 10 mm/s.
    ASSERT_NEAR(a[0].points[i].y, b[0].points[2 * i].y, 1e-6) << i;
    most = std::max(most, std::abs(a[0].points[i].y));
  }
  EXPECT_GT(most, 0.1);
}

TEST(HandLines, FollowSeedAndAmplitude) {
  const engine::Edge edge = longEdge();
  const auto drawn = [&](const OperatorSpec& spec) {
    return handLines({&edge, 1}, tenthGrid(), spec)[0].points;
  };
  OperatorSpec still, one, other;
  still.tremor_mm = still.wander_mm = 0.0;
  const std::vector<glm::dvec2> exact = drawn(still);
  for (const glm::dvec2& p : exact) EXPECT_EQ(p.y, 0.0);
  other.seed = 2;
  EXPECT_TRUE(drawn(one) == drawn(one));
  EXPECT_FALSE(drawn(one) == drawn(other));
  EXPECT_TRUE(handLines({}, tenthGrid(), one).empty());
}

}  // namespace
}  // namespace fettle::haptic
