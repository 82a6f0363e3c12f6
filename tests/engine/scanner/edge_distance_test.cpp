#include "engine/scanner/true_lines.h"

#include <cmath>

#include <gtest/gtest.h>

namespace fettle::engine {
namespace {

TEST(EdgeDistance, IsToTheNearestPieceOrEndAndAcrossTheClosingPiece) {
  Edge edge;
  EXPECT_TRUE(std::isinf(distanceFrom(edge, {0.0, 0.0})));
  edge.points_mm = {{0.0, 0.0}, {4.0, 0.0}, {4.0, 3.0}};
  EXPECT_DOUBLE_EQ(distanceFrom(edge, {2.0, 1.0}), 1.0);
  EXPECT_DOUBLE_EQ(distanceFrom(edge, {-3.0, -4.0}), 5.0);
  EXPECT_DOUBLE_EQ(distanceFrom(edge, {1.0, 2.0}), 2.0);
  edge.closed = true;  // the third side runs from (4, 3) to (0, 0)
  EXPECT_NEAR(distanceFrom(edge, {1.0, 2.0}), 1.0, 1e-12);
  edge.points_mm = {{1.0, 1.0}, {1.0, 1.0}};
  EXPECT_DOUBLE_EQ(distanceFrom(edge, {1.0, 3.0}), 2.0);
}

}  // namespace
}  // namespace fettle::engine
