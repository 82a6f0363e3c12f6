// Material ratio of a profile at a height, and heights of ratios, against closed formulas.
#include "engine/measure/profile_ratio.h"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/measure/roughness.h"

namespace fettle::engine {
namespace {

constexpr double kHalfTurn = std::numbers::pi;

// Whole waves: a triangle between -a and a has the ratio (1 - c / a) / 2, a sine of amplitude a acos(c / a) / kHalfTurn.
constexpr double kWaveAmplitude = 0.7;
constexpr int kWholeWaves = 5;

std::vector<double> profileOfWaves(std::size_t places, double (*wave)(double phase)) {
  std::vector<double> heights;
  for (std::size_t i = 0; i < places; ++i)
    heights.push_back(
        kWaveAmplitude *
        wave(std::fmod(kWholeWaves * static_cast<double>(i) / static_cast<double>(places - 1), 1.0)));
  return heights;
}

double triangleWave(double phase) {
  return 4.0 * std::abs(phase - 0.5) - 1.0;
}
double sineWave(double phase) {
  return std::sin(2.0 * kHalfTurn * phase);
}

// A triangleWave's corners are places here, so that the profile between places is the triangleWave itself.
TEST(ProfileRatio, OfATriangleIsItsFormulaToRounding) {
  const std::vector<double> profile = profileOfWaves(20 * kWholeWaves + 1, triangleWave);
  for (const double share : {-0.99, -0.53, 0.0, 0.2, 0.77, 1.0}) {
    EXPECT_NEAR(materialRatioAt(profile, share * kWaveAmplitude), 0.5 * (1.0 - share), 1e-12) << share;
    EXPECT_NEAR(heightOfRatio(profile, 0.5 * (1.0 - share)), share * kWaveAmplitude, 1e-12) << share;
  }
  EXPECT_EQ(materialRatioAt(profile, 1.01 * kWaveAmplitude), 0.0);
  EXPECT_EQ(materialRatioAt(profile, -1.01 * kWaveAmplitude), 1.0);
}

// Chords of m places a wave lie below and above the sine by a (2 pi / m)^2 / 8 at most; by that the height is off, and the ratio by it over the
// slope of the curve.
TEST(ProfileRatio, OfASineIsItsFormulaToTheChords) {
  constexpr std::size_t kPlaces = 400;  // of a wave
  const std::vector<double> profile = profileOfWaves(kPlaces * kWholeWaves + 1, sineWave);
  const double chord = kWaveAmplitude * std::pow(2.0 * kHalfTurn / kPlaces, 2) / 8.0;
  for (const double ratio : {0.02, 0.1, 0.37, 0.5, 0.8, 0.98}) {
    const double height = kWaveAmplitude * std::cos(kHalfTurn * ratio);
    EXPECT_NEAR(heightOfRatio(profile, ratio), height, 1.01 * chord) << ratio;
    EXPECT_NEAR(materialRatioAt(profile, height), ratio,
                1.01 * chord / (kWaveAmplitude * kHalfTurn * std::sin(kHalfTurn * ratio)))
        << ratio;
  }
}

// Of what is level the whole counts at its height, and nothing above.
TEST(ProfileRatio, LevelPartsCountAtTheirHeight) {
  const std::vector<double> profile{0.0, 0.0, 0.0, 1.0, 1.0};  // half, a rise, a quarter
  EXPECT_DOUBLE_EQ(materialRatioAt(profile, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(materialRatioAt(profile, 0.5), 0.25 + 0.125);
  EXPECT_DOUBLE_EQ(materialRatioAt(profile, 1.0), 0.25);
  EXPECT_DOUBLE_EQ(heightOfRatio(profile, 0.2), 1.0);
  EXPECT_NEAR(heightOfRatio(profile, 0.75), 0.0, 1e-12);
  const std::vector<double> flat{2.0, 2.0};
  EXPECT_EQ(materialRatioAt(flat, 2.0), 1.0);
  EXPECT_EQ(heightOfRatio(flat, 0.5), 2.0);
}

// Against the share of many places on the straight lines between the heights.
TEST(ProfileRatio, IsTheShareOfTheLineThatIsSoHigh) {
  std::mt19937_64 random(17);
  std::normal_distribution<double> normal;
  std::vector<double> profile(60);
  for (double& z : profile) z = normal(random);
  constexpr int kFine = 2000;
  for (const double height : {-1.3, -0.2, 0.0, 0.6, 1.9}) {
    int above = 0;
    for (std::size_t i = 0; i + 1 < profile.size(); ++i)
      for (int k = 0; k < kFine; ++k)
        above += std::lerp(profile[i], profile[i + 1], (k + 0.5) / kFine) >= height ? 1 : 0;
    const double share = above / (kFine * static_cast<double>(profile.size() - 1));
    EXPECT_NEAR(materialRatioAt(profile, height), share, 0.5 / kFine) << height;
    EXPECT_NEAR(heightOfRatio(profile, materialRatioAt(profile, height)), height, 1e-9) << height;
  }
}

// About the mean line of the profile that is measured: a primary profile of whole waves on a slope.
TEST(ProfileRatio, IsMeasuredWithTheOtherParametersAboutTheMeanLine) {
  Section section;
  section.step_mm = 0.01;
  section.height = profileOfWaves(400 * kWholeWaves + 1, sineWave);
  for (std::size_t i = 0; i < section.height.size(); ++i)
    section.height[i] += 5.0 + 1e-4 * static_cast<double>(i);
  section.covariance.assign(section.height.size(), 1.0);
  section.share.assign(section.height.size(), 1.0);
  section.position.resize(section.height.size());
  const auto found = roughnessOf(section, {0.0, section.lengthMm()}, {.kind = ProfileKind::kPrimary},
                                 {.at_heights_mm = {0.0, 0.35}, .between = {{0.1, 0.9}, {0.25, 0.5}}});
  ASSERT_TRUE(found) << found.error().line();
  ASSERT_EQ(found->ratios.size(), 2U);
  ASSERT_EQ(found->differences.size(), 2U);
  // The least-squares line of five sines is inclined: 0.14 of the amplitude from end to end, a few per cent of the ratios and heights.
  EXPECT_NEAR(found->ratios[0], 0.5, 0.01);
  EXPECT_NEAR(found->ratios[1], std::acos(0.5) / kHalfTurn, 0.03);
  EXPECT_NEAR(found->differences[0], kWaveAmplitude * (std::cos(0.1 * kHalfTurn) - std::cos(0.9 * kHalfTurn)),
              0.05);
  EXPECT_NEAR(found->differences[1],
              kWaveAmplitude * (std::cos(0.25 * kHalfTurn) - std::cos(0.5 * kHalfTurn)), 0.05);
}

}  // namespace
}  // namespace fettle::engine
