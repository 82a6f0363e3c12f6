#include "app/work/edge_strokes.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

using haptic::StrokeSample;
using haptic::Tool;

engine::Grid gridOf(double spacing_x_mm, double spacing_y_mm) {
  engine::Grid grid;
  grid.width = grid.height = 200;
  grid.spacing_x = spacing_x_mm;
  grid.spacing_y = spacing_y_mm;
  return grid;
}

TEST(EdgeStrokes, AreTheRunsOfTheMarkToolInSamples) {
  std::vector<StrokeSample> session;
  const auto add = [&](double x, double y, Tool tool) { session.push_back({0.0, {x, y, 0.0}, tool}); };
  for (int i = 0; i < 5; ++i) add(i, 0.0, Tool::kSmooth);
  for (int i = 0; i < 5; ++i) add(i, 1.0, Tool::kMark);
  add(9.0, 9.0, Tool::kFeel);
  for (int i = 0; i < 4; ++i) add(2.0, i, Tool::kMark);
  add(std::numeric_limits<double>::quiet_NaN(), 0.0, Tool::kMark);
  for (int i = 0; i < 3; ++i) add(3.0, i, Tool::kMark);
  add(9.0, 9.0, Tool::kUnmark);
  add(1.0, 1.0, Tool::kMark);  // one point is no stroke
  const auto strokes = edgeStrokesOf(session, gridOf(0.5, 0.25));
  ASSERT_EQ(strokes.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(strokes[i].id, static_cast<std::int64_t>(i));
  EXPECT_EQ(strokes[0].points, (std::vector<glm::dvec2>{{0, 4}, {2, 4}, {4, 4}, {6, 4}, {8, 4}}));
  EXPECT_EQ(strokes[1].points.size(), 4U);
  EXPECT_EQ(strokes[2].points.front(), glm::dvec2(6, 0));
  for (const auto& stroke : strokes) EXPECT_FALSE(stroke.closed);
}

TEST(EdgeStrokes, AStrokeThatComesBackToWhereItBeganIsClosed) {
  const auto ring = [](double turns, double radius) {
    std::vector<StrokeSample> session;
    for (int i = 0; i <= 400; ++i) {
      const double a = 6.283185307 * turns * i / 400;
      session.push_back({0.0, {100 + radius * std::cos(a), 100 + radius * std::sin(a), 0.0}, Tool::kMark});
    }
    return edgeStrokesOf(session, gridOf(1.0, 1.0)).at(0).closed;
  };
  EXPECT_TRUE(ring(0.99, 40.0));
  EXPECT_FALSE(ring(0.9, 40.0));
  EXPECT_FALSE(ring(0.99, 2.0));  // a dot
}

TEST(EdgeStrokes, NothingComesOfNothing) {
  EXPECT_TRUE(edgeStrokesOf({}, gridOf(1.0, 1.0)).empty());
}

}  // namespace
}  // namespace fettle::app
