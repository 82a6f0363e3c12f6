// Waviness of millimetres with noise of micrometres: what the robust filters' linear ones follow is no outlier.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/filter/gaussian_regression.h"
#include "tests/engine/filter/made_scan.h"
#include "tests/engine/filter/reference.h"

namespace fettle::engine::tests {
namespace {

constexpr int kWaveLong = 240, kWaveShort = 120, kWaveEnd = 20;  // samples; ends are two cut-offs wide
constexpr double kWaveSpacing = 0.1, kWaveCutOff = 1.0, kWaveNoise = 0.001;

struct Wave {
  double length = 8.0, phase = 0.0;
  bool along_y = false;
  double spikes = 0.0;  // share of the samples
};

struct WaveOff {
  double ends = 0.0, inside = 0.0;
};

double waveAt(const Wave& wave, int c, int r) {
  return 4.0 *
         std::sin(2.0 * std::numbers::pi * (wave.along_y ? r : c) * kWaveSpacing / wave.length + wave.phase);
}

MadeScan scanOfWave(const Wave& wave, bool plain) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0.0, kWaveNoise);
  std::uniform_real_distribution<double> chance;
  const int width = wave.along_y ? kWaveShort : kWaveLong, height = wave.along_y ? kWaveLong : kWaveShort;
  std::vector<double> z;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) {
      const double spike =
          chance(random) < wave.spikes ? (chance(random) < 0.5 ? -100.0 : 100.0) * kWaveNoise : 0.0;
      z.push_back(waveAt(wave, c, r) + (plain ? 0.0 : noise(random) + spike));
    }
  return {"wave", width, height, kWaveSpacing, kWaveSpacing, kWaveCutOff, [z, width](int c, int r) {
            return z[static_cast<std::size_t>(r * width + c)];
          }};
}

WaveOff offOf(const Wave& wave, const Version& field, const auto& heightAt) {
  WaveOff off;
  const int width = field.grid().width, height = field.grid().height;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) {
      const bool end = std::min({c, r, width - 1 - c, height - 1 - r}) < kWaveEnd;
      double& worst = end ? off.ends : off.inside;
      worst = std::max(worst, std::fabs(heightAt(c, r) - waveAt(wave, c, r)));
    }
  return off;
}

WaveOff linearOff(const Wave& wave, FilterKind kind) {
  const Version field = versionOf(scanOfWave(wave, true));
  if (kind == FilterKind::kRobustSpline) {
    const Version linear = filtered(field, nestingSpec(FilterKind::kSpline, kWaveCutOff)).field;
    return offOf(wave, field, [&](int c, int r) { return linear.reader().heightAt(c, r); });
  }
  JobControl job;
  const int width = field.grid().width, height = field.grid().height;
  GaussianRegression linear(field.reader(), kWaveCutOff, bestCpuLevel());
  EXPECT_TRUE(linear.prepare({}, job));
  std::vector<float> z(static_cast<std::size_t>(width * height + 16));
  EXPECT_TRUE(linear.fill({0, 0, width, height}, z.data(), width, job));
  return offOf(wave, field, [&](int c, int r) { return z[static_cast<std::size_t>(r * width + c)]; });
}

void expectLikeLinear(FilterKind kind, double spikes, double of_linear, double more) {
  for (const bool along_y : {false, true})
    for (const double length : {3.0, 4.0, 6.0, 8.0, 12.0, 24.0})
      for (const double phase : {0.0, 0.5 * std::numbers::pi}) {
        const Wave wave{length, phase, along_y, spikes};
        const Version field = versionOf(scanOfWave(wave, false));
        const Filtered got = filtered(field, nestingSpec(kind, kWaveCutOff));
        const WaveOff robust =
            offOf(wave, field, [&](int c, int r) { return got.field.reader().heightAt(c, r); });
        const WaveOff linear = linearOff(wave, kind);
        const std::string name = std::to_string(length) + (along_y ? " along y, " : " along x, ") +
                                 std::to_string(phase) + ", spikes " + std::to_string(spikes);
        EXPECT_LE(robust.ends, of_linear * linear.ends + more) << name;
        EXPECT_LE(robust.inside, of_linear * linear.inside + more) << name;
        EXPECT_LE(static_cast<double>(got.report.weightless), (0.04 + spikes) * 240 * 120) << name;
        EXPECT_EQ(warningOf(got.report), "") << name;
      }
}

// Noise that is left, and of the spline what weights below 1 at ends let it bend less: 5 um of 4 mm at most.
TEST(RobustWaves, OfLittleNoiseAreFollowedAsByTheLinearFilter) {
  expectLikeLinear(FilterKind::kRobustGaussian, 0.0, 1.01, 2.5 * kWaveNoise);
  expectLikeLinear(FilterKind::kRobustSpline, 0.0, 1.1, 5.0 * kWaveNoise);
}

// Where samples have no weight the surface is that of fewer ones, and bends less: 25 um of 4 mm at most.
TEST(RobustWaves, WithSpikesAreFollowedNearlyAsByTheLinearFilter) {
  expectLikeLinear(FilterKind::kRobustGaussian, 0.05, 1.15, 25.0 * kWaveNoise);
  expectLikeLinear(FilterKind::kRobustSpline, 0.05, 1.15, 25.0 * kWaveNoise);
}

}  // namespace
}  // namespace fettle::engine::tests
