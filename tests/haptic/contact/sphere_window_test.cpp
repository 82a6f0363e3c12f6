// A ball's copy of the field around it: heights and points straight under a place, up to the copy's border and not beyond.
#include "haptic/contact/sphere_window.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "haptic/contact/normal.h"
#include "tests/haptic/support/fields.h"

namespace fettle::haptic {
namespace {

using tests::fieldOf;
using tests::kHole;
using tests::uniform;

constexpr double kSx = 0.5, kSy = 1.5;

engine::Version wavy() {
  return fieldOf(
      60, 50, [](int c, int r) { return 3.0 + std::sin(0.7 * c) + 0.4 * r * std::cos(0.3 * c); }, kSx, kSy);
}

// Each place in the middle of the field lies in the same cell, has the same height, point and normal as the field itself.
TEST(SphereWindow, UnderAPlaceIsTheFieldsOwnPatch) {
  const engine::Version field = wavy();
  Surface surface(field.reader());
  std::mt19937_64 random(3);
  for (const BallSteps steps : {BallSteps::kInSpace, BallSteps::kInPlan}) {
    SphereWindow window(BallMinima::kAll, steps);
    window.load(surface, {15.0, 36.0, 0.0}, 2.0, 1.0);
    for (int i = 0; i < 400; ++i) {
      const glm::dvec3 at{uniform(random, 13.0, 17.0), uniform(random, 34.0, 38.0),
                          uniform(random, -9.0, 9.0)};
      CellIndex cell;
      Patch patch;
      ASSERT_TRUE(surface.cellUnder(at, cell) && surface.patch(cell, patch));
      SphereContact touch;
      ASSERT_TRUE(window.under(at, touch));
      EXPECT_EQ(touch.cell, cell);
      const double u = at.x / kSx - cell.column;
      const double v = at.y / kSy - cell.row;
      EXPECT_NEAR(touch.u, u, 1e-12);
      EXPECT_NEAR(touch.v, v, 1e-12);
      EXPECT_NEAR(glm::length(touch.point_mm - patch.at(u, v)), 0.0, 1e-11);
      EXPECT_NEAR(glm::length(touch.normal - patchNormal(patch, u, v)), 0.0, 1e-11);
      EXPECT_NEAR(touch.distance_mm, std::abs(at.z - patch.heightAt(u, v)), 1e-11);
      EXPECT_NEAR(window.heightUnder(at), patch.heightAt(u, v), 1e-11);
    }
  }
}

// A field that is smaller than the copy: its first and last samples count, nothing beside them does.
TEST(SphereWindow, ThereIsAHeightUpToTheFieldsBorderAndNoneBeyond) {
  const engine::Version field = fieldOf(4, 3, [](int c, int r) { return 10.0 + c + 2.0 * r; });
  Surface surface(field.reader());
  SphereWindow window;
  window.load(surface, {1.5, 1.0, 0.0}, 4.0, 1.0);
  SphereContact touch;
  for (const auto& [x, y] :
       {std::pair{0.0, 0.0}, {3.0, 2.0}, {0.0, 2.0}, {3.0, 0.0}, {1.0, 1.0}, {2.25, 1.5}}) {
    EXPECT_NEAR(window.heightUnder({x, y, 0.0}), 10.0 + x + 2.0 * y, 1e-12) << x << ' ' << y;
    ASSERT_TRUE(window.under({x, y, 0.0}, touch)) << x << ' ' << y;
    EXPECT_NEAR(touch.point_mm.z, 10.0 + x + 2.0 * y, 1e-12);
    EXPECT_TRUE(surface.hasCell(touch.cell)) << x << ' ' << y;
  }
  for (const auto& [x, y] : {std::pair{-1e-9, 1.0},
                             {3.0 + 1e-9, 1.0},
                             {1.0, -1e-9},
                             {1.0, 2.0 + 1e-9},
                             {-50.0, 1.0},
                             {50.0, 1.0},
                             {1.0, -50.0},
                             {1.0, 50.0}}) {
    EXPECT_EQ(window.heightUnder({x, y, 0.0}), -HUGE_VAL) << x << ' ' << y;
    EXPECT_FALSE(window.under({x, y, 0.0}, touch)) << x << ' ' << y;
  }
}

// Of a copy without holes that lies within the field, too: what is left and right of it is not read.
TEST(SphereWindow, ThereIsNoHeightBeyondTheCopy) {
  const engine::Version field = fieldOf(60, 60, [](int, int) { return 1.0; });
  Surface surface(field.reader());
  SphereWindow window;
  window.load(surface, {30.0, 30.0, 0.0}, 2.0, 1.0);
  // One cell more than the ball reaches, and its far samples: from 26 to 35 along each axis.
  for (const double inside : {26.0, 30.5, 35.0 - 1e-9}) {
    EXPECT_EQ(window.heightUnder({inside, 30.0, 0.0}), 1.0) << inside;
    EXPECT_EQ(window.heightUnder({30.0, inside, 0.0}), 1.0) << inside;
  }
  for (const double outside : {26.0 - 1e-9, 35.5, -1.0, 59.0}) {
    EXPECT_EQ(window.heightUnder({outside, 30.0, 0.0}), -HUGE_VAL) << outside;
    EXPECT_EQ(window.heightUnder({30.0, outside, 0.0}), -HUGE_VAL) << outside;
  }
}

// On a line between a cell with a hole and one without, the one without counts.
TEST(SphereWindow, OnALineBesideAHoleTheOtherCellCounts) {
  const engine::Version field =
      fieldOf(12, 12, [](int c, int r) { return c >= 6 ? static_cast<double>(kHole) : 2.0 + r; });
  Surface surface(field.reader());
  SphereWindow window;
  window.load(surface, {5.0, 5.0, 0.0}, 2.0, 1.0);
  SphereContact touch;
  ASSERT_TRUE(window.under({5.0, 4.5, 0.0}, touch));
  EXPECT_EQ(touch.cell, (CellIndex{4, 4}));
  EXPECT_EQ(touch.u, 1.0);
  EXPECT_NEAR(window.heightUnder({5.0, 4.5, 0.0}), 6.5, 1e-12);
  EXPECT_FALSE(window.under({5.2, 4.5, 0.0}, touch));
  EXPECT_EQ(window.heightUnder({5.2, 4.5, 0.0}), -HUGE_VAL);
}

}  // namespace
}  // namespace fettle::haptic
