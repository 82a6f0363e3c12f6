#include "engine/measure/features.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/engine/measure/fields.h"

namespace fettle::engine {
namespace {

FeatureParameters featuresOf(const Surface& surface, double sz) {
  JobControl job;
  const auto features = measureFeatures(surface, sz, 0.05, job);
  EXPECT_TRUE(features) << features.error().line();
  return features ? *features : FeatureParameters{};
}

std::vector<std::pair<std::string_view, double>> figuresOf(const FeatureParameters& p) {
  return {{"spd", p.spd},   {"svd", p.svd}, {"spc", p.spc}, {"svc", p.svc}, {"s5p", p.s5p}, {"s5v", p.s5v},
          {"s10z", p.s10z}, {"sha", p.sha}, {"sda", p.sda}, {"shv", p.shv}, {"sdv", p.sdv}};
}

// Why a parameter has no figure; empty where it has one.
std::string reasonOf(const FeatureParameters& p, std::string_view key) {
  const auto found = std::ranges::find(p.not_stated, key, &NotStated::parameter);
  return found == p.not_stated.end() ? "" : found->reason;
}

// A bump of 4 % of the height is part of the slope that it stands on, one of 6 % is a hill.
TEST(Features, BelowFivePerCentArePruned) {
  for (const auto& [share, count] : {std::pair{0.04, 1}, {0.06, 2}}) {
    const double bump = share;
    const Surface surface = surfaceOf(41, 5, [&](int c, int) {
      const double ramp = 1.0 - c / 40.0;
      return c == 20 ? ramp + 1.0 / 40.0 + bump : ramp;
    });
    // The saddle is the sample before the bump, one step of the ramp above it.
    EXPECT_EQ(featuresOf(surface, 1.0).hills, count) << share;
  }
}

TEST(Features, OfAParaboloidIsOneOfItsCurvature) {
  Surface surface = surfaceOf(41, 33, [](int c, int r) {
    return -((c - 20.0) * (c - 20.0) + 16.0 * (r - 15.0) * (r - 15.0)) / 2048.0;
  });
  surface.spacing_y = 4.0;
  surface.height_mm = 0.5;
  const FeatureParameters p = featuresOf(surface, 4.0);
  EXPECT_EQ(p.hills, 1);
  EXPECT_DOUBLE_EQ(p.spc, 0.5 / 1024.0);
  EXPECT_DOUBLE_EQ(p.spd, 1.0 / (41.0 * 33.0 * 4.0));
}

// Of radius R: 1 / R, and by second differences (2 R - 2 sqrt(R^2 - h^2)) / h^2.
TEST(Features, OfASphereIsOneOfItsRadius) {
  constexpr double kRadius = 40.0;
  const Surface surface = surfaceOf(15, 15, [](int c, int r) {
    return std::sqrt(kRadius * kRadius - (c - 7) * (c - 7) - (r - 7) * (r - 7)) - kRadius;
  });
  const double differences = 2.0 * kRadius - 2.0 * std::sqrt(kRadius * kRadius - 1.0);
  EXPECT_NEAR(featuresOf(surface, 1.0).spc / differences, 1.0, 1e-6);
  EXPECT_NEAR(differences * kRadius, 1.0, 2e-4);
}

// cos(kx) cos(ky): peaks at half waves of both, every other one; curvature A k^2, by second differences.
TEST(Features, OfCrossedSinesAreTheirPeaks) {
  constexpr int kWave = 20, kWaves = 6;
  constexpr double k = 2.0 * std::numbers::pi / kWave;
  Surface surface = surfaceOf(kWave * kWaves, kWave * kWaves, [](int c, int r) {
    return 3.0 * std::cos(k * (c - kWave / 4)) * std::cos(k * (r - kWave / 4));
  });
  surface.spacing_x = surface.spacing_y = 0.1;
  const FeatureParameters p = featuresOf(surface, 6.0);
  EXPECT_EQ(p.hills, 2 * kWaves * kWaves);
  EXPECT_DOUBLE_EQ(p.spd, 2.0 / (kWave * kWave * 0.01));
  EXPECT_NEAR(p.spc / (3.0 * 2.0 * (1.0 - std::cos(k)) / 0.01), 1.0, 1e-6);
  EXPECT_EQ(p.curved, p.hills);
}

TEST(Features, OfHardSurfacesAreAFigureOrAReason) {
  const auto check = [](const Surface& surface, double sz) {
    const FeatureParameters p = featuresOf(surface, sz);
    for (const auto& [key, value] : figuresOf(p)) {
      EXPECT_EQ(std::isfinite(value), reasonOf(p, key).empty()) << key << ' ' << value;
      EXPECT_FALSE(std::isinf(value)) << key;
    }
    return p;
  };
  EXPECT_FALSE(reasonOf(check(surfaceOf(0, 0, {}), 0.0), "spd").empty());
  EXPECT_FALSE(reasonOf(check(surfaceOf(9, 1, [](int c, int) { return c % 2; }), 1.0), "spd").empty());
  EXPECT_FALSE(reasonOf(check(surfaceOf(9, 9, [](int, int) { return 0.0; }), 0.0), "spd").empty());
  const FeatureParameters slope = check(surfaceOf(9, 9, [](int c, int) { return c; }), 8.0);
  EXPECT_EQ(slope.hills, 1);
  EXPECT_FALSE(reasonOf(slope, "spc").empty());
  EXPECT_NEAR(check(surfaceOf(9, 9, [](int c, int r) { return c == 4 && r == 4 ? 1e6 : 0.0; }), 1e6).spc, 2e6,
              1.0);
  // Two parts without a link: a hill each.
  EXPECT_EQ(check(surfaceOf(9, 9, [](int c, int r) { return c == 4 ? std::nan("") : -std::abs(r - 4); }), 4.0)
                .hills,
            2);
  JobControl job;
  job.cancel();
  EXPECT_EQ(
      measureFeatures(surfaceOf(400, 400, [](int c, int r) { return c * r; }), 1.0, 0.0, job).error().kind,
      ErrorKind::kCancelled);
}

// Its curvature needs a sample on each side, and no more than that.
TEST(Features, APeakBesideTheRimHasACurvatureAndOneOnItHasNone) {
  for (const auto& [column, row, curved] : {std::tuple{4, 3, 1},
                                            {1, 1, 1},
                                            {7, 3, 1},
                                            {4, 5, 1},
                                            {7, 5, 1},
                                            {0, 3, 0},
                                            {8, 3, 0},
                                            {4, 0, 0},
                                            {4, 6, 0}}) {
    Surface surface = surfaceOf(9, 7, [&](int c, int r) {
      return -0.125 * ((c - column) * (c - column) + 2.0 * (r - row) * (r - row));
    });
    const FeatureParameters features = featuresOf(surface, 10.0);
    EXPECT_EQ(features.hills, 1);
    EXPECT_EQ(features.curved, curved) << column << ' ' << row;
    if (curved > 0) {
      EXPECT_NEAR(features.spc, 0.5 * (0.25 + 0.5), 1e-6) << column << ' ' << row;
    }
  }
}

// A cos(kx) cos(ky) of whole waves: hills and dales alternate as the fields of a chessboard. A hill's ground is the diamond between four
// pits, half of a square wave; above its saddles, at 0, lies the square between zero lines, 4 A / k^2 of it by the integral and A / tan(k / 2)^2
// by the sum over samples, 0.8 % less here.
TEST(Features, OfAnEggCrateAreItsClosedForms) {
  constexpr int kWave = 40, kWaves = 5, kSide = kWave * kWaves + 1;
  constexpr double k = 2.0 * std::numbers::pi / kWave, kHigh = 3.0;
  for (const double spacing_y : {0.1, 0.4}) {
    Surface surface = surfaceOf(kSide, kSide, [](int c, int r) {
      return kHigh * std::cos(k * (c - kWave / 4)) * std::cos(k * (r - kWave / 4));
    });
    surface.spacing_x = 0.1;
    surface.spacing_y = spacing_y;
    surface.height_mm = 1e-3;
    const FeatureParameters p = featuresOf(surface, 2.0 * kHigh);
    const double cell = 0.1 * spacing_y;
    EXPECT_EQ(p.hills, 2 * kWaves * kWaves);
    EXPECT_EQ(p.dales, p.hills);
    EXPECT_DOUBLE_EQ(p.svd, 2.0 * kWaves * kWaves / (kSide * kSide * cell));
    EXPECT_NEAR(p.svc / p.spc, 1.0, 1e-6);
    EXPECT_GT(p.svc, 0.0);
    EXPECT_EQ(p.s5p, kHigh);
    EXPECT_EQ(p.s5v, kHigh);
    EXPECT_EQ(p.s10z, 2.0 * kHigh);
    const double sum = kHigh * 1e-3 * cell / (std::tan(0.5 * k) * std::tan(0.5 * k));
    EXPECT_NEAR(p.shv / sum, 1.0, 1e-6);
    EXPECT_NEAR(p.sdv / sum, 1.0, 1e-6);
    EXPECT_NEAR(sum / (4.0 * kHigh * 1e-3 * cell / (k * k)), 1.0, 0.01);
    // Samples on the diamond's sides, 4 * 20 of 800, go to one of two hills; of dales as of hills.
    EXPECT_NEAR(p.sha / (0.5 * kWave * kWave * cell), 1.0, 0.05);
    EXPECT_NEAR(p.sda / (0.5 * kWave * kWave * cell), 1.0, 0.05);
    EXPECT_TRUE(p.not_stated.empty());
  }
}

// The same with no sample on any of these lines, and a window that cuts the outer hills: what is left of them counts in neither mean.
TEST(Features, OfHillsThatTheBorderCutsNoAreaCounts) {
  constexpr double kWave = 31.7, k = 2.0 * std::numbers::pi / kWave;
  for (const double shift : {0.3, 5.1, 11.9}) {
    const Surface surface = surfaceOf(
        215, 190, [&](int c, int r) { return std::cos(k * (c - shift)) * std::cos(k * (r - 1.7 * shift)); });
    const FeatureParameters p = featuresOf(surface, 2.0);
    // Each of some 25 is counted to a share of the 64 samples along its sides.
    EXPECT_NEAR(p.sha / (0.5 * kWave * kWave), 1.0, 0.01) << shift;
    EXPECT_NEAR(p.sda / (0.5 * kWave * kWave), 1.0, 0.01) << shift;
    EXPECT_NEAR(p.shv / (4.0 / (k * k)), 1.0, 0.01) << shift;
    EXPECT_NEAR(p.sdv / (4.0 / (k * k)), 1.0, 0.01) << shift;
  }
}

// Dales are the hills of the surface upside down, and the other way round.
TEST(Features, OfASurfaceUpsideDownAreThoseOfTheOtherSide) {
  const auto wavy = [](int c, int r) {
    return std::sin(0.31 * c) * std::cos(0.23 * r) + 0.3 * std::sin(0.9 * c + 0.5 * r) + 0.002 * c;
  };
  const FeatureParameters up = featuresOf(surfaceOf(90, 80, wavy), 2.5);
  const FeatureParameters down =
      featuresOf(surfaceOf(90, 80, [&](int c, int r) { return -wavy(c, r); }), 2.5);
  EXPECT_GT(up.hills, 5);
  EXPECT_EQ(up.hills, down.dales);
  EXPECT_EQ(up.dales, down.hills);
  for (const auto& [one, other] : {std::pair{up.spd, down.svd},
                                   {up.spc, down.svc},
                                   {up.svc, down.spc},
                                   {up.s5p, down.s5v},
                                   {up.s10z, down.s10z},
                                   {up.sha, down.sda},
                                   {up.shv, down.sdv},
                                   {up.sdv, down.shv}})
    EXPECT_EQ(one, other);
}

// Five peaks of 1, 2 .. 6 less the lowest: 4 of five; of four hills there is no five-point height.
TEST(Features, FivePointHeightsAreOfTheFiveHighestPeaks) {
  const auto peaks = [](int count) {
    return surfaceOf(10 * count + 1, 11, [=](int c, int r) {
      const int number = c / 10;
      return std::max(0.0, 1.0 + number - std::hypot(c % 10 - 5.0, r - 5.0)) - 0.5;
    });
  };
  const FeatureParameters six = featuresOf(peaks(6), 6.0);
  EXPECT_EQ(six.hills, 6);
  EXPECT_DOUBLE_EQ(six.s5p, (2.0 + 3.0 + 4.0 + 5.0 + 6.0) / 5.0 - 0.5);
  const FeatureParameters four = featuresOf(peaks(4), 4.0);
  EXPECT_EQ(four.hills, 4);
  EXPECT_TRUE(std::isnan(four.s5p) && std::isnan(four.s10z));
  EXPECT_EQ(reasonOf(four, "s5p"), "there are 4 hills, and five are needed");
}

// One hole in the middle of a hill: part of its ground may be missing there.
TEST(Features, AHoleCutsTheHillThatItLiesIn) {
  constexpr int kWave = 20;
  constexpr double k = 2.0 * std::numbers::pi / kWave;
  const auto crate = [](int c, int r) { return std::cos(k * (c - 0.3)) * std::cos(k * (r - 0.3)); };
  const FeatureParameters whole = featuresOf(surfaceOf(45, 45, crate), 2.0);
  // Of the hills at (0, 0) .. (40, 40) with i + j even that at (20, 20) and its neighbours at 10 and 30 do not reach the border.
  const FeatureParameters holed = featuresOf(
      surfaceOf(45, 45,
                [&](int c, int r) {
                  const int i = (c + 5) / 10, j = (r + 5) / 10;
                  return (i + j) % 2 == 0 && c % 10 == 2 && r % 10 == 2 ? std::nan("") : crate(c, r);
                }),
      2.0);
  EXPECT_TRUE(std::isfinite(whole.sha) && std::isfinite(whole.shv));
  EXPECT_EQ(reasonOf(holed, "sha"), "every hill reaches the border or a hole");
  EXPECT_EQ(reasonOf(holed, "shv"), "every hill reaches the border or a hole above its saddle");
}

}  // namespace
}  // namespace fettle::engine
