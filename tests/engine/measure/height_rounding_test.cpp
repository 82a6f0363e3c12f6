// Derivatives of heights that floats hold badly: what is said of them against what they are.
#include "engine/measure/height_rounding.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/measure/form.h"

namespace fettle::engine {
namespace {

constexpr int kRoundedSide = 200;
constexpr double kRoundedSpacing = 0.01;

// Waves aslant, `high` and some 40 samples long, at a height above 0 [mm].
Version wavesAt(double height, double high) {
  Grid grid;
  grid.width = grid.height = kRoundedSide;
  grid.spacing_x = grid.spacing_y = kRoundedSpacing;
  grid.height_unit = {"mm", 1.0};
  std::vector<float> z;
  for (int r = 0; r < kRoundedSide; ++r)
    for (int c = 0; c < kRoundedSide; ++c)
      z.push_back(static_cast<float>(height + high * std::sin(0.13 * c + 0.07 * r) * std::cos(0.11 * r)));
  return makeField(grid, z);
}

ArealParameters arealOfWaves(const Version& field) {
  JobControl job;
  const auto fit = fitForm(field, {}, job);
  EXPECT_TRUE(fit);
  return *measureAreal(field, fit->form, {}, job);
}

// The excess of Sdq that is said is that of the same waves at 0, which floats hold.
TEST(HeightRounding, IsSaidWhereItMakesTheGradient) {
  for (const double high : {1e-4, 3e-5}) {
    const ArealParameters there = arealOfWaves(wavesAt(0.0, high)), here = arealOfWaves(wavesAt(100.0, high));
    const std::string doubt = roundingDoubt(wavesAt(100.0, high), here);
    const double excess = 100.0 * (1.0 - there.sdq / here.sdq);
    ASSERT_GT(excess, 1.0) << "the waves are lower than floats resolve";
    const auto at = doubt.find("Sdq about ");
    ASSERT_NE(at, std::string::npos) << doubt;
    EXPECT_NEAR(std::stod(doubt.substr(at + 10)), excess, 0.15 * excess) << doubt;
    EXPECT_NE(doubt.find("Spc"), std::string::npos) << doubt;
  }
}

TEST(HeightRounding, IsNotSaidWhereFloatsHoldTheSurface) {
  for (const double height : {0.0, 1.0, 100.0}) {
    const Version field = wavesAt(height, 0.1);
    EXPECT_EQ(roundingDoubt(field, arealOfWaves(field)), "") << height;
  }
  const Version flat = wavesAt(100.0, 0.0);
  EXPECT_EQ(roundingDoubt(flat, arealOfWaves(flat)), "");
}

}  // namespace
}  // namespace fettle::engine
