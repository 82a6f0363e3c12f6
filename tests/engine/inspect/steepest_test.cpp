#include "engine/inspect/steepest.h"

#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "tests/engine/inspect/grids.h"

namespace fettle::engine {
namespace {

SteepestCell steepest(const Version& field) {
  JobControl job;
  const auto cell = findSteepest(field, job);
  EXPECT_TRUE(cell);
  return cell.value_or(SteepestCell{});
}

TEST(Steepest, ItsProgressIsThatOfTheTiles) {
  JobControl job;
  ASSERT_TRUE(findSteepest(makeField(gridOf(200, 70), std::vector<float>(200 * 70, 1.0F)), job));
  EXPECT_EQ(job.stage(), std::string("finding the steepest cell"));
  EXPECT_EQ(job.total(), 4U * 2U);
  EXPECT_EQ(job.done(), job.total());
}

TEST(Steepest, IsWhereTheGradientOfTheBilinearPatchIsLongest) {
  // Against the gradient itself, sampled densely over each cell, on anisotropic cells in mixed units.
  Grid grid = gridOf(70, 67);
  grid.spacing_x = 2.0;
  grid.spacing_y = 0.5;
  grid.lateral_unit = {"um", 1e-3};
  grid.height_unit = {"nm", 1e-6};
  std::mt19937 random(5);
  std::vector<float> z;
  for (int i = 0; i < 70 * 67; ++i)
    z.push_back(i % 53 == 0 ? NAN : static_cast<float>(random() % 1000) * 0.1F);
  const Version field = makeField(grid, z);
  double best = -1.0;
  int column = 0, row = 0;
  for (int r = 0; r + 1 < 67; ++r)
    for (int c = 0; c + 1 < 70; ++c) {
      const auto at = [&](int dc, int dr) {
        return double{z[static_cast<std::size_t>((r + dr) * 70 + c + dc)]};
      };
      for (double u = 0.0; u <= 1.0; u += 0.25)
        for (double v = 0.0; v <= 1.0; v += 0.25) {
          const double x = ((at(1, 0) - at(0, 0)) * (1 - v) + (at(1, 1) - at(0, 1)) * v) * 1e-3 / 2.0;
          const double y = ((at(0, 1) - at(0, 0)) * (1 - u) + (at(1, 1) - at(1, 0)) * u) * 1e-3 / 0.5;
          if (std::hypot(x, y) > best) {
            best = std::hypot(x, y);
            column = c;
            row = r;
          }
        }
    }
  const SteepestCell cell = steepest(field);
  EXPECT_NEAR(cell.slope, best, 1e-12 * best);
  EXPECT_EQ(cell.column, column);
  EXPECT_EQ(cell.row, row);
}

TEST(Steepest, IsFoundAcrossTheBorderOfTiles) {
  std::vector<float> z(130 * 130, 0.0F);
  for (std::size_t r = 0; r < 130; ++r)
    for (std::size_t c = 64; c < 130; ++c) z[r * 130 + c] = 3.0F;
  const SteepestCell cell = steepest(makeField(gridOf(130, 130), z));
  EXPECT_EQ(cell.slope, 3.0);
  EXPECT_EQ(cell.column, 63);
  EXPECT_EQ(cell.row, 0);
}

TEST(Steepest, NeedsACellWithoutHoles) {
  EXPECT_TRUE(std::isnan(steepest(makeField(gridOf(4, 1), {1, 2, 3, 4})).slope));
  EXPECT_TRUE(std::isnan(steepest(makeField(gridOf(2, 2), {1, 2, 3, NAN})).slope));
  EXPECT_EQ(steepest(makeField(gridOf(2, 2), {5, 5, 5, 5})).slope, 0.0);
}

}  // namespace
}  // namespace fettle::engine
