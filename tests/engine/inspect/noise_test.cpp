#include "engine/inspect/noise.h"

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "engine/field/builder.h"

namespace fettle::engine {
namespace {

constexpr int kSide = 400;

// White noise of `sigma` on a surface; Box and Muller's own numbers, the same on every machine.
Version noisy(double sigma, const std::function<double(int, int)>& surface) {
  std::mt19937_64 random(41);
  std::vector<float> z;
  const auto uniform = [&] { return (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53; };
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) {
      const double normal = std::sqrt(-2.0 * std::log(uniform())) * std::cos(6.283185307179586 * uniform());
      z.push_back(static_cast<float>(surface(c, r) + sigma * normal));
    }
  Grid grid;
  grid.width = grid.height = kSide;
  return makeField(grid, z);
}

double sigmaOf(const Version& field) {
  JobControl job;
  const auto noise = estimateNoise(field, job);
  EXPECT_TRUE(noise);
  return noise ? noise->sigma : -1.0;
}

// The median of n independent |d|, d normal, has a relative standard error of 0.5 / (2 phi(0.6745) 0.6745
// sqrt(n)) = 1.17 / sqrt(n); windows overlap 9-fold, so that at least n = 398^2 / 9 count: 0.9 %. Four of
// these.
constexpr double kFourErrors = 0.036;

TEST(Noise, OfAFlatFieldIsItsSigma) {
  for (const double sigma : {1e-6, 0.02, 5.0})
    EXPECT_NEAR(sigmaOf(noisy(sigma, [](int, int) { return 0.0; })) / sigma, 1.0, kFourErrors);
}

TEST(Noise, IsNotRaisedByTilt) {
  const double sigma = 0.02;
  EXPECT_NEAR(sigmaOf(noisy(sigma, [](int c, int r) { return 0.7 * c - 1.3 * r + 0.01 * c * r; })) / sigma,
              1.0, kFourErrors);
}

TEST(Noise, IsNotRaisedBySteps) {
  const double sigma = 0.02;
  const auto along_columns = [](int c, int) { return c / 20 % 2 == 0 ? 0.0 : 8.0; };
  EXPECT_NEAR(sigmaOf(noisy(sigma, along_columns)) / sigma, 1.0, kFourErrors);
  // Slanted edges pass through some 2 x 3 windows of every 40 a row, round ones through fewer; the header
  // says what a share p of spoilt windows costs: 1.2 p.
  const auto slanted = [](int c, int r) { return (c + r) / 40 % 2 == 0 ? 0.0 : 8.0; };
  const double raised = sigmaOf(noisy(sigma, slanted)) / sigma;
  const double share = 4.0 / 40.0;
  EXPECT_GT(raised, 1.0);
  EXPECT_NEAR(raised, 1.0 + 1.2 * share, kFourErrors + share * share);
  const auto disc = [](int c, int r) { return std::hypot(c - 200, r - 200) < 120 ? 5.0 : 0.0; };
  EXPECT_NEAR(sigmaOf(noisy(sigma, disc)) / sigma, 1.0, kFourErrors + 1.2 * 4 * 754.0 / (kSide * kSide));
}

TEST(Noise, IsNotRaisedByHolesAndSpikes) {
  const double sigma = 0.02;
  int k = 0;
  const auto surface = [&k](int, int) {
    ++k;
    if (k % 97 == 0) return std::numeric_limits<double>::quiet_NaN();
    return k % 1009 == 0 ? 50.0 : 0.0;  // nine windows in a thousand
  };
  EXPECT_NEAR(sigmaOf(noisy(sigma, surface)) / sigma, 1.0, kFourErrors + 1.2 * 0.009);
}

TEST(Noise, OfSmoothSurfacesIsNone) {
  EXPECT_LT(sigmaOf(noisy(0.0, [](int c, int) { return 1e-3 * c * c; })), 1e-5);
  EXPECT_EQ(sigmaOf(noisy(0.0, [](int, int r) { return r < 7 ? 0.0 : 3.0; })), 0.0);
}

TEST(Noise, NeedsAWindowWithoutHoles) {
  Grid grid;
  grid.width = 5;
  grid.height = 2;
  EXPECT_TRUE(std::isnan(sigmaOf(makeField(grid, std::vector<float>(10, 1.0F)))));
  grid.height = 3;
  std::vector<float> z{0, 0, 0, 0, 0, 0, 6, 0, 0, NAN, 0, 0, 0, 0, 0};
  // Windows: about the 6 in the middle (|d| = 24) and next to it (12); the third has a hole. The lower
  // counts.
  EXPECT_NEAR(sigmaOf(makeField(grid, z)), 1.482602218505602 * 12.0 / 6.0, 1e-12);
}

TEST(Noise, CanBeCancelled) {
  JobControl job;
  job.cancel();
  const auto noise = estimateNoise(noisy(1.0, [](int, int) { return 0.0; }), job);
  ASSERT_FALSE(noise);
  EXPECT_EQ(noise.error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::engine
