#include "engine/inspect/noise_parts.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "engine/inspect/noise_model.h"
#include "engine/scanner/counter_random.h"
#include "tests/engine/inspect/grids.h"

namespace fettle::engine {
namespace {

constexpr int kPartsSide = 256;

using HeightAt = std::function<double(int, int)>;

NoiseModel modelOfHeights(int width, int height, const HeightAt& z) {
  std::vector<float> heights;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) heights.push_back(static_cast<float>(z(c, r)));
  JobControl job;
  const auto model = measureNoise(makeField(gridOf(width, height), heights), job);
  EXPECT_TRUE(model);
  return model ? *model : NoiseModel{};
}

// A rough surface of mean square 1 with a lay: its autocorrelation is exp(-(u^2 / a^2 + v^2 / b^2) / 4), u along a line
// at `degrees`, v across it.
std::vector<double> layAt(double degrees, double a, double b, std::uint64_t seed) {
  constexpr int kWaves = 60;
  const CounterRandom random(seed, 0);
  const double cosine = std::cos(degrees * std::numbers::pi / 180.0),
               sine = std::sin(degrees * std::numbers::pi / 180.0);
  std::vector<double> z(std::size_t{kPartsSide} * kPartsSide);
  for (int k = 0; k < kWaves; ++k) {
    const double u = random.normal(k, 0) / (a * std::numbers::sqrt2),
                 v = random.normal(k, 1) / (b * std::numbers::sqrt2);
    const double across = u * cosine - v * sine, up = u * sine + v * cosine;
    const double phase = 2.0 * std::numbers::pi * random.uniform(k, 2);
    for (int r = 0; r < kPartsSide; ++r)
      for (int c = 0; c < kPartsSide; ++c)
        z[static_cast<std::size_t>(r) * kPartsSide + static_cast<std::size_t>(c)] +=
            std::sqrt(2.0 / kWaves) * std::cos(across * c + up * r + phase);
  }
  return z;
}

double whiteOf(std::uint64_t seed, int c, int r) {
  return CounterRandom(seed, 0).normal(c, r);
}

// Of the variance: offsets, and the weights with which covariances are missing from squared fourth differences.
double sharedOf(const NoiseParts& parts) {
  constexpr double kWeights[] = {1.6, -0.8, 0.2285714, -0.0285714};
  double shared = parts.row_offset + parts.column_offset;
  for (std::size_t k = 0; k < 4; ++k) shared += kWeights[k] * (parts.along_row[k] + parts.along_column[k]);
  return shared / parts.variance();
}

// What lines share of all noise is known to some 0.007, whatever the lay: a surface without noise of lines has none, and
// such noise is found as on a flat field.
TEST(NoiseParts, OfASurfaceWithALayAreThoseOfTheNoise) {
  struct Case {
    const char* what;
    double shared;
    std::function<double(int, int)> noise;  // of mean square 1
  };
  const auto smoothed = [](int along, int line) {
    return (whiteOf(71, along - 1, line) + whiteOf(71, along, line) + whiteOf(71, along + 1, line)) /
           std::sqrt(3.0);
  };
  const double own = std::sqrt(0.8), lines = std::sqrt(0.2);
  const Case cases[] = {
      {"white", 0.0, [](int c, int r) { return whiteOf(71, c, r); }},
      {"rows", 0.2, [&](int c, int r) { return own * whiteOf(71, c, r) + lines * whiteOf(72, 0, r); }},
      {"columns", 0.2, [&](int c, int r) { return own * whiteOf(71, c, r) + lines * whiteOf(72, c, 0); }},
      // Correlations of 2/3 and 1/3: 1.6 * 2/3 - 0.8 / 3.
      {"means of three in a row", 0.8, [&](int c, int r) { return smoothed(c, r); }},
      {"means of three in a column", 0.8, [&](int c, int r) { return smoothed(r, c); }},
  };
  for (const double degrees : {0.0, 30.0, 90.0}) {
    const std::vector<double> surface = layAt(degrees, 9.0, 3.0, 73);
    for (const Case& one : cases) {
      const NoiseModel model = modelOfHeights(kPartsSide, kPartsSide, [&](int c, int r) {
        return surface[static_cast<std::size_t>(r) * kPartsSide + static_cast<std::size_t>(c)] +
               0.02 * one.noise(c, r);
      });
      EXPECT_NEAR(model.sigma, 0.02, 0.02 * 0.06) << one.what << ' ' << degrees;
      EXPECT_NEAR(sharedOf(model.parts), one.shared, 0.05) << one.what << ' ' << degrees;
      for (const auto& along : {model.parts.along_row, model.parts.along_column})
        for (const double covariance : along)
          EXPECT_LE(std::abs(covariance), model.parts.uncorrelated) << one.what << ' ' << degrees;
    }
  }
}

TEST(NoiseParts, OfWhatHasNoneAreNone) {
  for (const std::int64_t windows : {std::int64_t{0}, std::int64_t{1}, std::int64_t{8192}}) {
    const NoiseParts parts = noiseOf({}, windows);
    EXPECT_EQ(parts.variance(), 0.0);
    EXPECT_EQ(parts.along_row, NoiseParts{}.along_row);
  }
}

// Moments that no noise has: the parts are a noise's all the same.
TEST(NoiseParts, OfMomentsOfASurfaceStayANoise) {
  for (const double large : {1e-70, 1.0, 1e70})
    for (const double sign : {-1.0, 1.0})
      for (const double row_detail : {0.0, 0.9, 1.0, 1.1}) {
        NoiseMoments moments;
        moments.square = 50.0 * large;
        moments.along_row = {40.0 * sign * large, -40.0 * sign * large, 30.0 * large, -30.0 * large};
        moments.along_column = {-20.0 * large, 20.0 * large, 20.0 * large};
        moments.row_sum = 400.0 * large;
        moments.column_sum = 300.0 * large;
        moments.row_detail = row_detail * large;
        moments.column_detail = large;
        const NoiseParts parts = noiseOf(moments, 500);
        EXPECT_NEAR(parts.variance(), moments.detail(), 1e-12 * large);
        EXPECT_GE(parts.uncorrelated, 0.0);
        EXPECT_GE(parts.row_offset, 0.0);
        EXPECT_GE(parts.column_offset, 0.0);
        // Three errors of sqrt(4 * 2.63 / 128,000) besides.
        EXPECT_LE(sharedOf(parts), std::abs(1.0 - row_detail) * large / moments.detail() + 0.028);
      }
}

TEST(NoiseParts, OfHardFieldsAreANoise) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> lay = layAt(0.0, 9.0, 3.0, 74);
  const auto rough = [&](int c, int r) {
    return lay[static_cast<std::size_t>(r) * kPartsSide + static_cast<std::size_t>(c)] +
           0.02 * whiteOf(75, c, r);
  };
  struct Case {
    const char* what;
    int width, height;
    HeightAt z;
    double sigma;  // 0: none
  };
  const Case cases[] = {
      {"all equal", kPartsSide, kPartsSide, [](int, int) { return 3.0; }, 0.0},
      {"one row", kPartsSide, 1, [&](int c, int) { return rough(c, 0); }, kNone},
      {"one column", 1, kPartsSide, [&](int, int r) { return rough(0, r); }, kNone},
      {"holes alone", kPartsSide, kPartsSide, [](int, int) { return kNone; }, kNone},
      {"spikes", kPartsSide, kPartsSide,
       [&](int c, int r) { return (c * 251 + r) % 1009 == 0 ? 1e6 : rough(c, r); }, 0.02},
      {"holes", kPartsSide, kPartsSide,
       [&](int c, int r) { return (c * 251 + r) % 97 == 0 ? kNone : rough(c, r); }, 0.02},
      {"infinite", kPartsSide, kPartsSide,
       [&](int c, int r) {
         return (c * 251 + r) % 1009 == 0 ? std::numeric_limits<double>::infinity() : rough(c, r);
       },
       0.02},
  };
  for (const Case& one : cases) {
    const NoiseModel model = modelOfHeights(one.width, one.height, one.z);
    if (std::isnan(one.sigma)) {
      EXPECT_TRUE(std::isnan(model.sigma)) << one.what;
      continue;
    }
    if (one.sigma == 0.0) {
      EXPECT_EQ(model.sigma, 0.0) << one.what;
      continue;
    }
    EXPECT_NEAR(model.sigma, one.sigma, 0.06 * one.sigma) << one.what;
    EXPECT_NEAR(model.parts.variance(), model.sigma * model.sigma, 1e-12 * model.sigma * model.sigma)
        << one.what;
    EXPECT_LT(std::abs(sharedOf(model.parts)), 0.05) << one.what;
  }
}

}  // namespace
}  // namespace fettle::engine
