#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "engine/compare/compare.h"
#include "engine/field/builder.h"
#include "tests/support/no_data.h"

namespace fettle::engine {
namespace {

struct Raster {
  Grid grid;
  std::vector<float> z;
  std::vector<std::uint8_t> marks;

  Raster(int width, int height, const std::function<double(int, int)>& f) {
    grid.width = width;
    grid.height = height;
    for (int r = 0; r < height; ++r)
      for (int c = 0; c < width; ++c) z.push_back(static_cast<float>(f(c, r)));
    marks.assign(z.size(), 0);
  }
  [[nodiscard]] std::size_t at(int c, int r) const { return static_cast<std::size_t>(r * grid.width + c); }
  [[nodiscard]] Version field() const { return makeField(grid, z); }
  [[nodiscard]] Version edges() const { return makeField(grid, z, marks); }
};

TruthFigures judged(const Version& field, const Version& truth, const Version& edges,
                    const TruthOptions& options = {}) {
  JobControl job;
  Result<TruthFigures> f = compareToTruth(field, truth, edges, job, options);
  if (!f) throw std::runtime_error(f.error().line());
  return *f;
}

// A step of `step` across the line cos(a) x + sin(a) y = d (in samples), with the sample nearest the line
// marked in each row or column, whichever the line crosses more often.
Raster slantedStep(int n, double degrees, double at, double step, double tilt = 0.0) {
  const double a = degrees * 3.14159265358979323846 / 180.0;
  const auto side = [=](double c, double r) {
    return std::cos(a) * (c - n / 2.0) + std::sin(a) * (r - n / 2.0) - at;
  };
  Raster raster(n, n,
                [=](int c, int r) { return (side(c, r) > 0.0 ? step : 0.0) + tilt * c - 0.5 * tilt * r; });
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; ++c)
      if (std::abs(side(c, r)) <= 0.5 * std::max(std::abs(std::cos(a)), std::abs(std::sin(a))))
        raster.marks[raster.at(c, r)] = 1;
  return raster;
}

// Box mean of n x n samples; the border samples stay.
std::vector<float> blurred(const Raster& from, int n) {
  std::vector<float> z = from.z;
  const int h = n / 2;
  for (int r = h; r + h < from.grid.height; ++r)
    for (int c = h; c + h < from.grid.width; ++c) {
      double sum = 0.0;
      for (int dr = -h; dr <= h; ++dr)
        for (int dc = -h; dc <= h; ++dc) sum += static_cast<double>(from.z[from.at(c + dc, r + dr)]);
      z[from.at(c, r)] = static_cast<float>(sum / (n * n));
    }
  return z;
}

TEST(Truth, NearAndFlatAreWhatBruteForceSays) {
  std::mt19937 random(4);
  Raster raster(150, 140, [&](int, int) { return static_cast<double>(random() % 1000); });
  for (int k = 0; k < 12; ++k) raster.marks[random() % raster.marks.size()] = 1;
  raster.marks.front() = 1;  // in a corner
  Raster field = raster;
  for (float& z : field.z) z += static_cast<float>(random() % 7);
  field.z[77] = kNan;
  TruthOptions options;
  options.near_edge = 3.0;
  options.flat = 12.5;
  std::int64_t near = 0;
  std::int64_t flat = 0;
  double near_square = 0.0;
  double flat_square = 0.0;
  for (int r = 0; r < 140; ++r)
    for (int c = 0; c < 150; ++c) {
      double d = 1e9;
      for (int rr = 0; rr < 140; ++rr)
        for (int cc = 0; cc < 150; ++cc)
          if (raster.marks[raster.at(cc, rr)] != 0) d = std::min(d, std::hypot(c - cc, r - rr));
      const double e = static_cast<double>(field.z[field.at(c, r)] - raster.z[raster.at(c, r)]);
      if (std::isnan(e)) continue;
      if (d <= 3.0) ++near, near_square += e * e;
      if (d > 12.5) ++flat, flat_square += e * e;
    }
  const TruthFigures f = judged(field.field(), raster.field(), raster.edges(), options);
  EXPECT_EQ(f.samples, 150 * 140 - 1);
  EXPECT_EQ(f.lost, 1);
  EXPECT_EQ(f.edge_samples, near);
  EXPECT_EQ(f.flat_samples, flat);
  // Integers: the sums are exact.
  EXPECT_EQ(f.rmse_edge, std::sqrt(near_square / static_cast<double>(near)));
  EXPECT_EQ(f.rmse_flat, std::sqrt(flat_square / static_cast<double>(flat)));
}

TEST(Truth, WithoutMarksAllIsFlatAndNothingNearAnEdge) {
  const Raster raster(70, 30, [](int c, int) { return c; });
  const TruthFigures f = judged(raster.field(), raster.field(), raster.edges());
  EXPECT_EQ(f.flat_samples, 70 * 30);
  EXPECT_EQ(f.edge_samples, 0);
  EXPECT_EQ(f.rmse_flat, 0.0);
  EXPECT_TRUE(std::isnan(f.rmse_edge) && std::isnan(f.edge_width) && std::isnan(f.max_abs_edge));
  EXPECT_EQ(f.edge_profiles, 0);
}

TEST(Truth, OneSampleAndOneRowAreJudgedWithoutProfiles) {
  for (const auto& [w, h] : {std::pair{1, 1}, {200, 1}, {1, 200}}) {
    Raster raster(w, h, [](int c, int r) { return c + r > 50 ? 1.0 : 0.0; });
    std::fill(raster.marks.begin(), raster.marks.end(), std::uint8_t{1});
    const TruthFigures f = judged(raster.field(), raster.field(), raster.edges());
    EXPECT_EQ(f.rmse, 0.0);
    EXPECT_EQ(f.edge_samples, w * h);
    EXPECT_EQ(f.edge_profiles, 0);
  }
}

// An upright wall lies between two samples; linear interpolation between them makes 0.8 samples of it.
TEST(EdgeWidth, OfAnIdealStepAlongTheGridIsTheSamplingsOwnLimit) {
  for (const double degrees : {0.0, 90.0, 180.0, 270.0}) {
    const Raster step = slantedStep(128, degrees, 0.3, 2.0);
    const TruthFigures f = judged(step.field(), step.field(), step.edges());
    EXPECT_GE(f.edge_profiles, 4);
    EXPECT_NEAR(f.edge_width, 0.8, 1e-6);
    EXPECT_EQ(f.edge_width, f.edge_width_truth);
  }
}

// A box of n samples turns the step into a straight ramp n samples long that meets the levels at its ends:
// 10 to 90 % is 0.8 n, at every sample exactly, so by linear interpolation too (float heights: 1e-6).
TEST(EdgeWidth, OfABoxBlurredStepAlongTheGridIsFourFifthsOfTheWindow) {
  for (const int n : {3, 5, 7, 9, 15})
    for (const double tilt : {0.0, 0.05}) {
      Raster step = slantedStep(128, 90.0, -0.2, 2.0, tilt);
      const Version truth = step.field();
      const Version edges = step.edges();
      step.z = blurred(step, n);
      const TruthFigures f = judged(step.field(), truth, edges);
      EXPECT_GE(f.edge_profiles, 4);
      EXPECT_NEAR(f.edge_width, 0.8 * n, 1e-4 * n) << n << " tilt " << tilt;
    }
}

// Across a slanted line the box's footprint is a trapezium: the convolution of two uniforms of n cos(a) and
// n sin(a). Its distribution function gives the width by bisection; the bins of half a sample smear it by up
// to half a sample in all.
TEST(EdgeWidth, OfABoxBlurredSlantedStepIsThatOfTheFootprint) {
  for (const double degrees : {15.0, 33.0, 45.0, 70.0}) {
    const int n = 9;
    const double a = degrees * 3.14159265358979323846 / 180.0;
    const double p = n * std::abs(std::cos(a));
    const double q = n * std::abs(std::sin(a));
    const auto ramp = [](double x) { return x > 0.0 ? 0.5 * x * x : 0.0; };
    const auto share = [&](double x) {
      return (ramp(x + (p + q) / 2) - ramp(x + (p - q) / 2) - ramp(x - (p - q) / 2) + ramp(x - (p + q) / 2)) /
             (p * q);
    };
    double low = 0.0;
    double high = n;
    for (int i = 0; i < 60; ++i) (share(0.5 * (low + high)) < 0.9 ? low : high) = 0.5 * (low + high);
    Raster step = slantedStep(160, degrees, 0.17, 3.0);
    const Version truth = step.field();
    const Version edges = step.edges();
    step.z = blurred(step, n);
    const TruthFigures f = judged(step.field(), truth, edges);
    EXPECT_GE(f.edge_profiles, 4);
    EXPECT_NEAR(f.edge_width, 2.0 * low, 0.5) << degrees;
    EXPECT_LT(f.edge_width_truth, 1.0) << degrees;
  }
}

TEST(EdgeWidth, IsInMillimetresAlsoOnUnlikeSpacings) {
  // Edge across x: only the spacing of x counts.
  Raster step = slantedStep(160, 0.0, 0.3, 2.0);
  step.grid.spacing_x = 0.05;
  step.grid.spacing_y = 0.08;
  step.grid.origin_x = 5e6;
  const Version truth = step.field();
  const Version edges = step.edges();
  step.z = blurred(step, 5);
  const TruthFigures f = judged(step.field(), truth, edges);
  EXPECT_GE(f.edge_profiles, 4);
  EXPECT_NEAR(f.edge_width, 0.8 * 5 * 0.05, 1e-4);
}

TEST(EdgeWidth, HoldsUnderNoise) {
  // Sigma 5 % of the step; a profile's bins average some 17 samples along a straight edge, so each
  // carries 1.2 % of the step, and the two crossings of a ramp 7 samples long (14 % a sample) move by 0.12
  // samples or so; the median over more than 8 profiles is well within 0.35.
  Raster step = slantedStep(256, 0.0, 0.3, 2.0);
  const Version truth = step.field();
  const Version edges = step.edges();
  std::mt19937 random(8);
  std::normal_distribution<double> normal(0.0, 0.1);
  step.z = blurred(step, 7);
  for (float& z : step.z) z += static_cast<float>(normal(random));
  const TruthFigures f = judged(step.field(), truth, edges);
  EXPECT_GE(f.edge_profiles, 8);
  EXPECT_NEAR(f.edge_width, 0.8 * 7, 0.35);
}

TEST(EdgeWidth, FollowsARoundWall) {
  const auto disc = [](int c, int r) { return std::hypot(c - 100.2, r - 99.7) < 60.0 ? 4.0 : 1.0; };
  Raster step(200, 200, disc);
  for (int r = 0; r < 200; ++r)
    for (int c = 0; c < 200; ++c)
      if (std::abs(std::hypot(c - 100.2, r - 99.7) - 60.0) <= 0.5) step.marks[step.at(c, r)] = 1;
  const Version truth = step.field();
  const Version edges = step.edges();
  const TruthFigures ideal = judged(truth, truth, edges);
  EXPECT_GE(ideal.edge_profiles, 8);
  EXPECT_LT(ideal.edge_width, 1.0);
  step.z = blurred(step, 7);
  // Between the 0.8 * 7 along the grid and the footprint across 45 degrees (7 * 0.78).
  EXPECT_NEAR(judged(step.field(), truth, edges).edge_width, 5.5, 0.4);
}

TEST(EdgeWidth, LeavesOutCornersRibsAndCreases) {
  Raster corner(90, 90, [](int c, int r) { return c > 44 && r > 44 ? 2.0 : 0.0; });
  for (int k = -3; k <= 3; ++k) corner.marks[corner.at(45 + std::max(k, 0), 45 - std::min(k, 0))] = 1;
  EXPECT_EQ(judged(corner.field(), corner.field(), corner.edges()).edge_profiles, 0);

  Raster rib(90, 90, [](int c, int) { return c >= 44 && c <= 46 ? 2.0 : 0.0; });
  Raster crease(90, 90, [](int c, int) { return std::abs(c - 45) * 0.7; });
  for (Raster* raster : {&rib, &crease}) {
    for (int r = 0; r < 90; ++r) raster->marks[raster->at(45, r)] = raster->marks[raster->at(44, r)] = 1;
    EXPECT_EQ(judged(raster->field(), raster->field(), raster->edges()).edge_profiles, 0);
  }
}

TEST(EdgeWidth, CountsWhatTheFieldNoLongerSpansAndSkipsWhatItLost) {
  const Raster step = slantedStep(128, 0.0, 0.3, 2.0);
  Raster flat = step;
  std::fill(flat.z.begin(), flat.z.end(), 1.0F);
  const TruthFigures gone = judged(flat.field(), step.field(), step.edges());
  EXPECT_EQ(gone.edge_profiles, 0);
  EXPECT_GE(gone.unresolved_profiles, 4);
  EXPECT_TRUE(std::isnan(gone.edge_width));
  std::fill(flat.z.begin(), flat.z.end(), kNan);
  const TruthFigures lost = judged(flat.field(), step.field(), step.edges());
  EXPECT_EQ(lost.edge_profiles + lost.unresolved_profiles, 0);
  EXPECT_EQ(lost.lost, 128 * 128);
}

TEST(EdgeWidth, IsTheSameUpsideDownTogether) {
  Raster step = slantedStep(128, 20.0, 0.3, 2.0);
  const Version truth = step.field();
  const Version edges = step.edges();
  step.z = blurred(step, 5);
  const Version field = step.field();
  EXPECT_NEAR(judged(field, truth, edges).edge_width,
              judged(field.inverted(), truth.inverted(), edges).edge_width, 0.05);
}

// A profile that is longer along the edge than the largest patch, for samples three times as high as wide.
TEST(EdgeWidth, OfAMirrorImageIsTheSame) {
  const auto judgedOnce = [](int way) {
    const auto edgeAt = [way](int c) {
      const double x = way * (c - 150);
      return 60.3 + 0.03 * x + 2e-4 * x * x;
    };
    Raster step(301, 121, [&](int c, int r) { return r > edgeAt(c) ? 2.0 : 0.0; });
    step.grid.spacing_y = 3.0;
    step.marks[step.at(150, 60)] = 1;
    const Version truth = step.field(), edges = step.edges();
    for (int r = 0; r < 121; ++r)
      for (int c = 0; c < 301; ++c)
        step.z[step.at(c, r)] = static_cast<float>(1.0 + std::tanh(0.6 * (r - edgeAt(c))));
    TruthOptions options;
    options.profile_half_length = 64;
    return judged(step.field(), truth, edges, options);
  };
  const TruthFigures one = judgedOnce(1), mirrored = judgedOnce(-1);
  ASSERT_EQ(one.edge_profiles, 1);
  ASSERT_EQ(mirrored.edge_profiles, 1);
  // Only the order of sums differs.
  EXPECT_NEAR(one.edge_width, mirrored.edge_width, 1e-9);
  EXPECT_NEAR(one.edge_width_truth, mirrored.edge_width_truth, 1e-9);
}

TEST(Truth, GivesTheSameBitsForAnyNumberOfThreads) {
  Raster step = slantedStep(300, 20.0, 0.3, 2.0);
  const Version truth = step.field();
  const Version edges = step.edges();
  step.z = blurred(step, 5);
  const Version field = step.field();
  const TruthFigures first = judged(field, truth, edges);
  for (const std::size_t threads : {1, 3, 8}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const TruthFigures f = judged(field, truth, edges);
    EXPECT_EQ(f.rmse, first.rmse);
    EXPECT_EQ(f.rmse_edge, first.rmse_edge);
    EXPECT_EQ(f.edge_width, first.edge_width);
  }
}

TEST(Truth, RefusesUnlikeSizesAndOptionsOutOfRange) {
  JobControl job;
  const Raster a(4, 4, [](int, int) { return 0.0; });
  const Raster b(4, 5, [](int, int) { return 0.0; });
  EXPECT_FALSE(compareToTruth(b.field(), a.field(), a.edges(), job));
  EXPECT_FALSE(compareToTruth(a.field(), a.field(), b.edges(), job));
  TruthOptions options;
  options.near_edge = 13.0;
  EXPECT_FALSE(compareToTruth(a.field(), a.field(), a.edges(), job, options));
  options = {};
  options.profile_reach = 65;
  EXPECT_FALSE(compareToTruth(a.field(), a.field(), a.edges(), job, options));
  options = {};
  options.flat = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(compareToTruth(a.field(), a.field(), a.edges(), job, options));
  job.cancel();
  const auto stopped = compareToTruth(a.field(), a.field(), a.edges(), job);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::engine
