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

// What rounding has of an rms is what the same waves at 0 have not: to the scatter of 40,000 roundings, a hundredth.
TEST(HeightRounding, OfAnRmsIsTheShareThatRoundingHas) {
  const double high = 3e-5;
  const auto squareOf = [&](double height) {
    const Version field = wavesAt(height, high);
    double sum = 0.0;
    for (int r = 0; r < kRoundedSide; ++r)
      for (int c = 0; c < kRoundedSide; ++c) {
        const double wave = high * std::sin(0.13 * c + 0.07 * r) * std::cos(0.11 * r);
        sum += std::pow(field.reader().heightAt(c, r) - height - wave, 2);
      }
    return sum / (kRoundedSide * kRoundedSide);
  };
  // As if the waves were what is left: rounding alone is, of the squares.
  const double rounding = squareOf(100.0), rms = std::sqrt(5.0 * rounding);
  const Version field = wavesAt(100.0, high), other = wavesAt(0.0, high);
  const std::string doubt = roundingDoubt({&field}, rms, "the rms of waves");
  const auto at = doubt.find("which has ");
  ASSERT_NE(at, std::string::npos) << doubt;
  EXPECT_NEAR(std::stod(doubt.substr(at + 10)), 20.0, 1.0) << doubt;
  EXPECT_NE(doubt.find(" % of the square of the rms of waves"), std::string::npos) << doubt;
  // Of two fields both count; here one has none to speak of.
  EXPECT_EQ(roundingDoubt({&other, &field}, rms, "the rms of waves").substr(0, 40), doubt.substr(0, 40));
  EXPECT_EQ(roundingDoubt({&field}, 10.0 * rms, "the rms of waves"), "");
  EXPECT_EQ(roundingDoubt({&field}, 0.0, "the rms of waves"), "");
  EXPECT_EQ(roundingDoubt({&other}, rms, "the rms of waves"), "");
}

}  // namespace
}  // namespace fettle::engine
