#include "engine/filter/robust_gaussian.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/filter/gaussian_regression.h"
#include "engine/filter/middle_distance.h"
#include "engine/filter/robust_weights.h"
#include "tests/engine/filter/made_scan.h"
#include "tests/engine/filter/reference.h"
#include "tests/engine/filter/robust_reference.h"

namespace fettle::engine::tests {
namespace {

double ripple(int c, int r) {
  return std::sin(12.9898 * c + 78.233 * r + 0.01 * c * r);
}

// The hard cases: cut-offs of few samples and of nodes 1 to 16 samples apart, beyond the field, holes, walls, spikes, unequal spacing,
// one row, and heights far from 0.
std::vector<MadeScan> regressionScans() {
  const auto holed = [](int c, int r) {
    return (c * 5 + r * 3) % 13 == 0 || (c > 15 && c < 30 && r > 10 && r < 20) ? std::nan("") : ripple(c, r);
  };
  return {
      {"two samples", 50, 40, 0.1, 0.1, 0.2, holed},
      {"few samples", 50, 40, 0.1, 0.1, 0.65, holed},
      {"nodes are samples", 60, 50, 0.1, 0.1, 1.3, holed},
      {"nodes of two", 60, 45, 0.1, 0.1, 2.6,
       [](int c, int r) { return ripple(c, r) + (c > 30 ? 50.0 : 0.0); }},
      {"nodes of eight", 90, 70, 0.1, 0.1, 9.0, holed},
      {"spacing 1:4", 80, 30, 0.25, 1.0, 6.0, holed},
      {"beyond the field", 50, 60, 1.0, 1.0, 300.0, holed},
      {"far beyond", 50, 40, 1.0, 1.0, 1e7, holed},
      {"a spike", 50, 50, 1.0, 1.0, 12.0,
       [](int c, int r) { return c == 20 && r == 25 ? 1e6 : ripple(c, r); }},
      {"far up", 40, 40, 1.0, 1.0, 9.0, [](int c, int r) { return 1e6 + 100.0 * ripple(c, r); }},
      {"one row", 300, 1, 1.0, 1.0, 40.0, ripple},
      {"one column", 1, 300, 1.0, 1.0, 40.0, ripple},
      {"one sample", 1, 1, 1.0, 1.0, 2.0, [](int, int) { return 5.0; }},
  };
}

std::vector<float> regressionOf(const Version& field, double nesting, const std::vector<float>& weights) {
  JobControl job;
  const int width = field.grid().width, height = field.grid().height;
  GaussianRegression filter(field.reader(), nesting, bestCpuLevel());
  EXPECT_TRUE(filter.prepare({weights.empty() ? nullptr : weights.data(), nullptr, width}, job));
  std::vector<float> z(static_cast<std::size_t>(width * height + 16));
  EXPECT_TRUE(filter.fill({0, 0, width, height}, z.data(), width, job));
  return z;
}

TEST(GaussianRegression, IsTheLeastSumOfItsDefinition) {
  for (const MadeScan& scan : regressionScans()) {
    const Version field = versionOf(scan);
    const std::vector<double> z = heightsOf(field);
    for (const bool weighted : {false, true}) {
      std::vector<float> weights(z.size() + 16, 1.0F);
      // Rough, and none in stripes askew that are a third of all.
      for (std::size_t i = 0; weighted && i < z.size(); ++i) {
        const int c = static_cast<int>(i) % scan.width, r = static_cast<int>(i) / scan.width;
        weights[i] = (c + r) % 30 >= 20 ? 0.0F : static_cast<float>(0.5 + 0.5 * ripple(c, 3));
      }
      const std::vector<double> in_double(weights.begin(), weights.end());
      const std::vector<float> got = regressionOf(field, scan.nesting, weights);
      int compared = 0;
      for (std::size_t i = 0; i < z.size(); ++i) {
        if ((z.size() > 400 && i % 7 != 0) || std::isnan(z[i])) continue;
        const PlainHeight plain = plainHeight(scan, z, in_double, static_cast<int>(i) % scan.width,
                                              static_cast<int>(i) / scan.width);
        // Beyond 1.25 cut-offs of the Gaussian weights end: of less weight than here those would have a share.
        if (plain.clearance < 1.01 || plain.weight < 1e-2) continue;
        ++compared;
        // Terms that are determined by a thousandth only multiply what moments are off by.
        ASSERT_NEAR(got[i], plain.z,
                    0.5 * static_cast<double>(ulp(got[i])) +
                        (weighted ? 1e-4 : 5e-6) * (plain.distance + std::fabs(plain.z)))
            << scan.name << (weighted ? ", weighted, " : ", ") << i;
      }
      EXPECT_GT(compared, static_cast<int>(std::min<std::size_t>(z.size(), 400) / 14)) << scan.name;
    }
  }
}

// (1 + q) exp(-q), q = 1.678 (L / wave)^2, whether samples or nodes are summed, along x, y and askew.
TEST(GaussianRegression, TransmitsWhatTheStandardStates) {
  for (const double cut_off : {4.0, 12.0, 40.0})
    for (const double degrees : {0.0, 90.0, 37.0})
      for (const double waves : {0.7, 1.0, 2.0, 5.0}) {
        const double wave = waves * cut_off, spacing = cut_off / 30.0;
        const double kx = 2.0 * std::numbers::pi / wave * std::cos(degrees * std::numbers::pi / 180.0),
                     ky = 2.0 * std::numbers::pi / wave * std::sin(degrees * std::numbers::pi / 180.0);
        const MadeScan scan{"wave", 280, 140, spacing, 2.0 * spacing, cut_off, [&](int c, int r) {
                              return std::cos(kx * spacing * (c - 140) + ky * 2.0 * spacing * (r - 70));
                            }};
        const std::vector<float> got = regressionOf(versionOf(scan), cut_off, {});
        const double q = 1.678346990016661 / (waves * waves), passed = (1.0 + q) * std::exp(-q);
        for (int r = 65; r <= 75; r += 5)
          for (int c = 100; c <= 180; c += 9)
            ASSERT_NEAR(got[static_cast<std::size_t>(r * 280 + c)], passed * scan.z(c, r), 1e-6)
                << cut_off << ", " << degrees << ", " << waves;
      }
}

TEST(RobustGaussian, LeavesPolynomialsOfSecondDegreeToTheirEnds) {
  for (const double cut_off : {3.0, 9.0, 14.0, 40.0, 1e5})
    for (const double along_y : {1.0, 3.0}) {
      const MadeScan scan{"bowl", 130, 90, 1.0, along_y, cut_off * along_y, [](int c, int r) {
                            return (c * 7 + r) % 11 == 0 || (c > 50 && c < 80 && r > 20 && r < 60)
                                       ? std::nan("")
                                       : 100.0 + 0.5 * c - 0.25 * r + 0.015625 * c * c - 0.0078125 * c * r +
                                             0.00390625 * r * r;
                          }};
      // Exact heights of up to 430: 1e-6 of what a window spans.
      EXPECT_LE(
          filtered(versionOf(scan), nestingSpec(FilterKind::kRobustGaussian, scan.nesting)).report.max_change,
          5e-4)
          << cut_off << ", " << along_y;
    }
}

// The weights of a sample by its definition, and the surface by normal equations, round by round.
TEST(RobustGaussian, IsWhatPlainRoundsFind) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<double> noises;
  for (int i = 0; i < 4000; ++i) noises.push_back(noise(random));
  const auto rough = [&](int c, int r) {
    return noises[static_cast<std::size_t>((c * 61 + r * 977) % 4000)];
  };
  const auto holed = [&](int c, int r) {
    return (c * 5 + r * 3) % 13 == 0 || (c > 10 && c < 15 && r > 8 && r < 14) ? std::nan("") : rough(c, r);
  };
  const std::vector<MadeScan> scans{
      {"a groove", 32, 24, 1.0, 1.0, 9.0, [&](int c, int r) { return holed(c, r) - (c == 20 ? 30.0 : 0.0); }},
      {"nodes", 40, 30, 1.0, 1.0, 12.0, [&](int c, int r) { return holed(c, r) + 0.02 * c * c; }},
      {"spacing 1:3", 48, 24, 1.0, 3.0, 18.0, [&](int c, int r) { return rough(c, r) + 0.5 * r; }},
      {"a spike", 32, 24, 1.0, 1.0, 9.0,
       [&](int c, int r) { return c == 12 && r == 15 ? 1e6 : holed(c, r); }},
      {"a wave of little noise", 32, 24, 1.0, 1.0, 10.0,
       [&](int c, int r) { return 0.05 * rough(c, r) + 40.0 * std::sin(0.1 * c); }},
      {"one row", 200, 1, 1.0, 1.0, 20.0, rough},
  };
  for (const MadeScan& scan : scans) {
    const Version field = versionOf(scan);
    const std::vector<double> z = heightsOf(field);
    const PlainRobust plain = plainRobust(scan, z);
    EXPECT_LT(plain.rounds, kMostRobustRounds) << scan.name;
    const Filtered got = filtered(field, nestingSpec(FilterKind::kRobustGaussian, scan.nesting));
    const PlainField surface = toPlain(got.field);
    std::int64_t weightless = 0;
    for (std::size_t i = 0; i < z.size(); ++i)
      if (!std::isnan(z[i])) {
        if (plain.weights[i] == 0.0) ++weightless;
        ASSERT_NEAR(surface.z[i], plain.surface[i],
                    1e-5 * plain.limit + 0.5 * static_cast<double>(ulp(surface.z[i])))
            << scan.name << ", " << i;
      }
    EXPECT_EQ(got.report.weightless, weightless) << scan.name;
  }
}

// Peaks of one sample in a flat: the median ends as 0, and so do the peaks' weights before.
TEST(RobustGaussian, PassesUnderPeaksOfAFlat) {
  const MadeScan scan{
      "flat", 90, 70, 1.0, 1.0, 20.0, [](int c, int r) { return (c * 7 + r * 11) % 23 == 0 ? 5.0 : 0.25; }};
  const Version field = versionOf(scan);
  const Filtered got = filtered(field, nestingSpec(FilterKind::kRobustGaussian, 20.0));
  for (int r = 0; r < 70; ++r)
    for (int c = 0; c < 90; ++c) ASSERT_NEAR(got.field.reader().heightAt(c, r), 0.25, 1e-5) << c << ", " << r;
}

// Two levels 50 times the noise apart: neither side's samples hold the other's surface farther than 0.6 cut-offs away.
TEST(RobustGaussian, ReachesBothLevelsOfAStep) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> noise(0.0, 1.0);
  const MadeScan scan{
      "step", 200, 100, 1.0, 1.0, 30.0, [&](int c, int) { return noise(random) + (c >= 100 ? 50.0 : 0.0); }};
  const Version robust =
      filtered(versionOf(scan), nestingSpec(FilterKind::kRobustGaussian, scan.nesting)).field;
  for (int c = 0; c < 200; ++c) {
    const double off =
        std::fabs(static_cast<double>(robust.reader().heightAt(c, 50)) - (c >= 100 ? 50.0 : 0.0));
    if (c < 82 || c >= 118) {
      EXPECT_LT(off, 1.5) << c;
    }
  }
}

// A groove a third of a cut-off wide holds half of the weight of a window over it.
TEST(RobustGaussian, PassesOverGroovesAThirdOfTheCutOffWide) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> noise(0.0, 1.0);
  const MadeScan scan{"groove", 200, 100, 1.0, 1.0, 30.0, [&](int c, int) {
                        return noise(random) - (c >= 100 && c < 110 ? 40.0 : 0.0);
                      }};
  const Version field = versionOf(scan);
  for (const FilterKind kind : {FilterKind::kRobustGaussian, FilterKind::kRobustSpline}) {
    const Version robust = filtered(field, nestingSpec(kind, scan.nesting)).field;
    for (int c = 0; c < 200; ++c) EXPECT_NEAR(robust.reader().heightAt(c, 50), 0.0, 0.5) << c;
  }
}

// A third of the samples on a level of their own: what they are to the surface is for a person to say.
TEST(RobustGaussian, WarnsWhereManySamplesHaveNoWeight) {
  std::mt19937_64 random(13);
  std::normal_distribution<double> noise(0.0, 1.0);
  const MadeScan scan{"pits", 120, 100, 1.0, 1.0, 30.0, [&](int c, int r) {
                        return noise(random) - (c % 6 < 3 && r % 6 < 4 ? 100.0 : 0.0);
                      }};
  const Filtered got = filtered(versionOf(scan), nestingSpec(FilterKind::kRobustGaussian, scan.nesting));
  EXPECT_EQ(got.report.samples, 120 * 100);
  EXPECT_NEAR(static_cast<double>(got.report.weightless) / (120.0 * 100.0), 2.0 / 6.0, 0.02);
  EXPECT_NE(warningOf(got.report).find("of the samples have no weight"), std::string::npos);
  EXPECT_EQ(warningOf({}), "");
}

// A groove of a tenth of the width and 40 times the noise: the linear surface sinks into it, the robust one does not.
TEST(RobustGaussian, PassesOverGrooves) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, 1.0);
  const MadeScan scan{"groove", 300, 120, 1.0, 1.0, 80.0, [&](int c, int) {
                        return noise(random) - (c >= 140 && c < 150 ? 40.0 : 0.0);
                      }};
  const Version field = versionOf(scan);
  const Version linear = filtered(field, nestingSpec(FilterKind::kArealGaussian, 80.0)).field,
                robust = filtered(field, nestingSpec(FilterKind::kRobustGaussian, 80.0)).field;
  // 10 samples of a Gaussian of width 0.47 * 80 = 37.6: 0.264 of its weight in the middle.
  EXPECT_NEAR(linear.reader().heightAt(145, 60), -40.0 * 0.264, 0.2);
  EXPECT_NEAR(robust.reader().heightAt(145, 60), 0.0, 0.1);
}

TEST(RobustGaussian, TakesTheMedianOfAllDistances) {
  for (const int width : {1, 2, 7, 150}) {
    const MadeScan scan{"any", width, 65, 1.0, 1.0, 0.0, [](int c, int r) {
                          return (c + r) % 9 == 1 ? std::nan("") : 100.0 * std::sin(5.0 * c + 3.0 * r);
                        }};
    const Version field = versionOf(scan);
    std::vector<float> surface(static_cast<std::size_t>(width) * 65, 0.25F), distances;
    for (int r = 0; r < 65; ++r)
      for (int c = 0; c < width; ++c)
        if (const float z = field.reader().heightAt(c, r); !std::isnan(z))
          distances.push_back(static_cast<float>(std::fabs(static_cast<double>(z) - 0.25)));
    std::ranges::sort(distances);
    const std::size_t n = distances.size();
    EXPECT_EQ(
        middleDistance(field.reader(), surface.data(), width),
        0.5 * static_cast<double>(distances[(n - 1) / 2]) + 0.5 * static_cast<double>(distances[n / 2]));
  }
}

}  // namespace
}  // namespace fettle::engine::tests
