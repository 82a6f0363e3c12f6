#include "engine/measure/profile_spectrum.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "tests/engine/measure/fields.h"
#include "tests/support/no_data.h"

namespace fettle::engine {
namespace {

using std::numbers::pi;

Autocorrelation correlationOf(Surface surface, double spacing_y = 1.0) {
  surface.spacing_y = spacing_y;
  JobControl job;
  return correlate(surface, job)->correlation;
}

double powerOf(const ProfileSpectrum& spectrum) {
  double sum = 0.0;
  for (std::size_t i = 0; i < spectrum.density.size(); ++i)
    sum += (i == 0 || i + 1 == spectrum.density.size() ? 0.5 : 1.0) * spectrum.density[i];
  return sum * spectrum.step;
}

// The definition, term by term.
double plainDensity(const Autocorrelation& c, ProfileAxis axis, std::size_t k, double mean_square) {
  const bool x = axis == ProfileAxis::kX;
  const int count = (x ? c.lags_x : c.lags_y) + 1;
  double sum = 1.0;
  for (int i = 1; i < count; ++i)
    sum += 2.0 * (x ? c.at(i, 0) : c.at(0, i)) * (0.5 + 0.5 * std::cos(pi * i / count)) *
           std::cos(pi * static_cast<double>(k) * i / count);
  return 2.0 * (x ? c.spacing_x : c.spacing_y) * mean_square * sum;
}

TEST(ProfileSpectrum, IsItsDefinitionAndHoldsAllPower) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const Autocorrelation c = correlationOf(surfaceOf(90, 61, [&](int, int) { return normal(random); }), 0.25);
  for (const ProfileAxis axis : {ProfileAxis::kX, ProfileAxis::kY}) {
    const ProfileSpectrum spectrum = profileSpectrum(c, axis, 2.5);
    ASSERT_EQ(spectrum.density.size(), axis == ProfileAxis::kX ? 47U : 32U);
    // Up to half of the samples' frequency.
    EXPECT_NEAR(spectrum.frequency(spectrum.density.size() - 1), axis == ProfileAxis::kX ? 0.5 : 2.0, 1e-12);
    for (std::size_t k = 0; k < spectrum.density.size(); ++k)
      EXPECT_NEAR(spectrum.density[k], plainDensity(c, axis, k, 2.5), 1e-12) << k;
    EXPECT_NEAR(powerOf(spectrum), 2.5, 1e-12);
  }
}

// White noise of variance 1: 2 per 1/mm everywhere. Von Hann's window up to lag M of profiles of N samples leaves 2.67 N / M = 5.3
// degrees of freedom of each of 256 profiles (Blackman and Tukey): a deviation of sqrt(2 / 1360) = 0.038 of the density.
TEST(ProfileSpectrum, OfWhiteNoiseIsFlat) {
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  const ProfileSpectrum spectrum = profileSpectrum(
      correlationOf(surfaceOf(256, 256, [&](int, int) { return normal(random); })), ProfileAxis::kX, 1.0);
  ASSERT_EQ(spectrum.density.size(), 130U);
  // At 0 and beside it the mean, which was taken out, is missing.
  for (std::size_t k = 2; k + 1 < spectrum.density.size(); ++k)
    EXPECT_NEAR(spectrum.density[k], 2.0, 2.0 * 5.0 * 0.038) << k;
  double mean = 0.0;
  for (std::size_t k = 2; k + 1 < spectrum.density.size(); ++k)
    mean += spectrum.density[k] / static_cast<double>(spectrum.density.size() - 3);
  EXPECT_NEAR(mean, 2.0, 0.03);
}

TEST(ProfileSpectrum, OfASineIsALineOfItsPowerAtItsFrequency) {
  // 12 waves in 240 samples of 1 mm, amplitude 3.
  const Autocorrelation c =
      correlationOf(surfaceOf(240, 40, [](int x, int) { return 3.0 * std::sin(2.0 * pi * x / 20.0); }));
  const ProfileSpectrum spectrum = profileSpectrum(c, ProfileAxis::kX, 4.5);
  const auto peak = static_cast<std::size_t>(
      std::max_element(spectrum.density.begin(), spectrum.density.end()) - spectrum.density.begin());
  EXPECT_NEAR(spectrum.frequency(peak), 0.05, 0.5 * spectrum.step);
  double near = 0.0;
  for (std::size_t k = peak - 3; k <= peak + 3; ++k) near += spectrum.density[k] * spectrum.step;
  EXPECT_NEAR(near, 4.5, 0.02 * 4.5);
  // Across it nothing changes: all power is at frequency 0.
  const ProfileSpectrum across = profileSpectrum(c, ProfileAxis::kY, 4.5);
  EXPECT_EQ(std::max_element(across.density.begin(), across.density.end()), across.density.begin());
}

TEST(ProfileSpectrum, LagsWithoutAValueEndIt) {
  // Two columns of samples at the ends: lags in between have no pairs.
  const Autocorrelation c = correlationOf(surfaceOf(64, 64, [](int x, int y) {
    return x < 4 || x > 59 ? std::sin(0.7 * x + y) : static_cast<double>(kNan);
  }));
  const ProfileSpectrum spectrum = profileSpectrum(c, ProfileAxis::kX, 1.0);
  EXPECT_LT(spectrum.density.size(), 8U);
  for (const double density : spectrum.density) EXPECT_TRUE(std::isfinite(density));
  EXPECT_TRUE(profileSpectrum(Autocorrelation{}, ProfileAxis::kX, 1.0).density.empty());
}

}  // namespace
}  // namespace fettle::engine
