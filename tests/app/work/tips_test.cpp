#include "app/work/tips.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

engine::Grid gridOf(double spacing_x, double spacing_y) {
  engine::Grid grid;
  grid.width = grid.height = 100;
  grid.spacing_x = spacing_x;
  grid.spacing_y = spacing_y;
  return grid;
}

TEST(Tips, GoFromThePointToLargerBallsAndBack) {
  const haptic::Scene start = haptic::defaultScene();
  const engine::Grid grid = gridOf(0.05, 0.05);
  const ChosenTip small = nextTip(start, grid);
  EXPECT_EQ(small.name, "ball, radius 1 cell");
  EXPECT_EQ(small.scene.tip, haptic::TipShape::kSphere);
  EXPECT_DOUBLE_EQ(small.scene.tip_radius_mm, 0.05);
  const ChosenTip large = nextTip(small.scene, grid);
  EXPECT_EQ(large.name, "ball, radius 2 cells");
  EXPECT_DOUBLE_EQ(large.scene.tip_radius_mm, 0.1);
  const ChosenTip point = nextTip(large.scene, grid);
  EXPECT_EQ(point.name, "point");
  haptic::Scene back = point.scene;
  back.tip_radius_mm = start.tip_radius_mm;  // nothing to a point
  EXPECT_EQ(back, start);
}

TEST(Tips, ARadiusBetweenThemGoesToTheNextLargerOne) {
  haptic::Scene scene = haptic::defaultScene();
  scene.tip = haptic::TipShape::kSphere;
  scene.tip_radius_mm = 0.07;
  EXPECT_EQ(nextTip(scene, gridOf(0.05, 0.05)).name, "ball, radius 2 cells");
  scene.tip_radius_mm = 0.5;
  EXPECT_EQ(nextTip(scene, gridOf(0.05, 0.05)).name, "point");
}

TEST(Tips, KeepTheLevelAndGiveItTheRoundsThatItNeeds) {
  haptic::Scene scene = haptic::defaultScene();
  scene.level = haptic::ContactLevel::kDescent;
  scene.search_rounds = 5;
  const engine::Grid grid = gridOf(0.05, 0.05);
  for (int i = 0; i < 3; ++i) scene = nextTip(scene, grid).scene;
  EXPECT_EQ(scene.tip, haptic::TipShape::kPoint);
  EXPECT_EQ(scene.level, haptic::ContactLevel::kDescent);
  EXPECT_EQ(scene.search_rounds, 5);
  // Of a ball with few steps a tick the point would be refused.
  scene.level = haptic::ContactLevel::kPaper;
  scene.tip = haptic::TipShape::kSphere;
  scene.tip_radius_mm = 0.1;
  const haptic::Scene point = nextTip(scene, grid).scene;
  EXPECT_EQ(point.tip, haptic::TipShape::kPoint);
  EXPECT_EQ(haptic::sceneProblem(point), std::nullopt);
}

// Radii are in the larger spacing, and no ball is larger than 16 of the smaller.
TEST(Tips, LeaveOutBallsThatTheFieldCannotHave) {
  EXPECT_EQ(nextTip(haptic::defaultScene(), gridOf(0.01, 1.0)).name, "point");
  const ChosenTip small = nextTip(haptic::defaultScene(), gridOf(0.1, 1.0));
  EXPECT_EQ(small.name, "ball, radius 1 cell");
  EXPECT_EQ(nextTip(small.scene, gridOf(0.1, 1.0)).name, "point");
}

}  // namespace
}  // namespace fettle::app
