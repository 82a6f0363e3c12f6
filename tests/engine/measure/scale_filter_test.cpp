#include "engine/measure/scale_filter.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "engine/field/builder.h"
#include "engine/measure/form.h"

namespace fettle::engine {
namespace {

using std::numbers::pi;

struct Scan {
  Grid grid;
  std::vector<float> heights;
  std::vector<std::uint8_t> marks;

  Scan(std::int32_t width, std::int32_t height, double spacing_x, double spacing_y,
       const std::function<double(int, int)>& z) {
    grid.width = width;
    grid.height = height;
    grid.spacing_x = spacing_x;
    grid.spacing_y = spacing_y;
    for (int r = 0; r < height; ++r)
      for (int c = 0; c < width; ++c) heights.push_back(static_cast<float>(z(c, r)));
  }
  [[nodiscard]] Version field() const { return makeField(grid, heights, marks); }
};

FilterSpec gaussianOf(double cut_off) {
  FilterSpec spec;
  spec.kind = FilterKind::kArealGaussian;
  spec.nesting_mm = cut_off;
  return spec;
}

Version filtered(const Version& field, double cut_off, Waves waves) {
  JobControl job;
  auto result = scaleFiltered(field, gaussianOf(cut_off), waves, job);
  EXPECT_TRUE(result) << result.error().line();
  return result ? *result : field;
}

// A wave of the cut-off's length keeps half of its amplitude, in every direction and for spacing 1:4; other waves what
// the standard states, exp(-pi (a L / wave)^2).
TEST(ScaleFilter, TransmitsHalfAtTheCutOff) {
  constexpr double kCutOff = 8.0;
  for (const double degrees : {0.0, 90.0, 37.0})
    for (const double wave : {kCutOff, 2.0 * kCutOff, 0.5 * kCutOff}) {
      const double kx = 2.0 * pi / wave * std::cos(degrees * pi / 180.0);
      const double ky = 2.0 * pi / wave * std::sin(degrees * pi / 180.0);
      const auto z = [&](int c, int r) { return std::cos(kx * 0.125 * (c - 150) + ky * 0.5 * (r - 40)); };
      const Version field = Scan(301, 81, 0.125, 0.5, z).field();
      const double passed = std::exp(-std::numbers::ln2 * (kCutOff / wave) * (kCutOff / wave));
      const Version low = filtered(field, kCutOff, Waves::kLong),
                    high = filtered(field, kCutOff, Waves::kShort);
      // Farther than the cut-off from the border.
      for (int r = 20; r <= 60; r += 4)
        for (int c = 80; c <= 220; c += 7) {
          EXPECT_NEAR(low.reader().heightAt(c, r), passed * z(c, r), 1e-6) << degrees << ", " << wave;
          EXPECT_NEAR(high.reader().heightAt(c, r), (1.0 - passed) * z(c, r), 1e-6)
              << degrees << ", " << wave;
        }
    }
}

// Every sample by plain sums of weights over the samples that there are, at borders and holes.
TEST(ScaleFilter, IsWhatPlainLoopsFind) {
  std::mt19937_64 random(6);
  std::normal_distribution<double> noise;
  constexpr double kCutOff = 3.0;
  Scan scan(41, 23, 0.25, 1.0, [&](int c, int r) {
    const double z = 500.0 + 0.5 * c - 0.2 * r + noise(random);
    return (c * 5 + r * 3) % 13 == 0 || (c > 30 && r < 6) ? std::nan("") : z;
  });
  for (std::size_t i = 0; i < scan.heights.size(); ++i) scan.marks.push_back(i % 7 == 0 ? 1 : 0);
  const Version field = scan.field(), low = filtered(field, kCutOff, Waves::kLong);
  JobControl job;
  const auto plane = fitForm(field, {.degree = 1, .region = Region::kAll, .robust = false}, job);
  ASSERT_TRUE(plane);
  const long double width = std::sqrt(std::log(2.0L) / std::numbers::pi_v<long double>) * kCutOff;
  for (int r = 0; r < 23; ++r)
    for (int c = 0; c < 41; ++c) {
      EXPECT_EQ(low.reader().markedAt(c, r), field.reader().markedAt(c, r));
      if (std::isnan(field.reader().heightAt(c, r))) {
        EXPECT_TRUE(std::isnan(low.reader().heightAt(c, r)));
        continue;
      }
      long double sum = 0, weights = 0;
      for (int v = std::max(0, r - 3); v <= std::min(22, r + 3); ++v)
        for (int u = std::max(0, c - 12); u <= std::min(40, c + 12); ++u) {
          const long double z = field.reader().heightAt(u, v);
          if (std::isnan(z)) continue;
          const long double x = 0.25L * (u - c) / width, y = 1.0L * (v - r) / width;
          const long double weight = std::exp(-std::numbers::pi_v<long double> * (x * x + y * y));
          sum += weight * (z - plane->form.heightAt(u, v));
          weights += weight;
        }
      // One rounding to float of heights of 495 to 525.
      EXPECT_NEAR(low.reader().heightAt(c, r),
                  plane->form.heightAt(c, r) + static_cast<double>(sum / weights), 3.1e-5)
          << c << ", " << r;
    }
}

TEST(ScaleFilter, OfAConstantIsThatConstant) {
  const Version field = Scan(60, 50, 1.0, 1.0, [](int, int) { return 0.1; }).field();
  const Version low = filtered(field, 7.0, Waves::kLong), high = filtered(field, 7.0, Waves::kShort);
  for (int r = 0; r < 50; ++r)
    for (int c = 0; c < 60; ++c) {
      ASSERT_EQ(low.reader().heightAt(c, r), 0.1F);
      ASSERT_NEAR(high.reader().heightAt(c, r), 0.0, 1e-15);
    }
}

// Weights of one side alone would bend its ends.
TEST(ScaleFilter, OfAPlaneIsThatPlane) {
  const auto plane = [](int c, int r) { return c == 20 && r > 10 ? std::nan("") : 0.5 * c - 2.0 * r; };
  const Version low = filtered(Scan(60, 50, 1.0, 1.0, plane).field(), 12.0, Waves::kLong);
  for (int r = 0; r < 50; ++r)
    for (int c = 0; c < 60; ++c)
      if (!std::isnan(plane(c, r))) {
        ASSERT_NEAR(low.reader().heightAt(c, r), plane(c, r), 1e-5);
      }
}

// White noise keeps the sum of squared weights: (1 / (sqrt(2) a L))^2 of its variance.
TEST(ScaleFilter, LeavesOfNoiseItsSquaredWeights) {
  std::mt19937_64 random(12);
  std::normal_distribution<double> noise;
  constexpr double kCutOff = 6.0;
  const Version low = filtered(Scan(600, 600, 1.0, 1.0, [&](int, int) { return noise(random); }).field(),
                               kCutOff, Waves::kLong);
  double sum = 0.0;
  int samples = 0;
  for (int r = 10; r < 590; ++r)
    for (int c = 10; c < 590; ++c, ++samples) sum += std::pow(low.reader().heightAt(c, r), 2);
  const double width = std::sqrt(std::numbers::ln2 / pi) * kCutOff;
  // 580^2 / (2 * width^2) = 21,000 independent values: 1 % of a variance; three of them.
  EXPECT_NEAR(sum / samples * 2.0 * width * width, 1.0, 0.03);
}

TEST(ScaleFilter, OfHardFieldsIsFinite) {
  const auto check = [](const Scan& scan, double cut_off) {
    const Version field = scan.field();
    for (const Waves waves : {Waves::kLong, Waves::kShort}) {
      const Version result = filtered(field, cut_off, waves);
      for (int r = 0; r < scan.grid.height; ++r)
        for (int c = 0; c < scan.grid.width; ++c)
          ASSERT_EQ(std::isfinite(result.reader().heightAt(c, r)),
                    std::isfinite(field.reader().heightAt(c, r)));
    }
  };
  check(Scan(1, 1, 1.0, 1.0, [](int, int) { return 5.0; }), 2.0);
  check(Scan(90, 1, 1.0, 1.0, [](int c, int) { return c % 2; }), 1e9);
  check(Scan(40, 40, 1.0, 4.0, [](int c, int r) { return c == 3 && r < 3 ? r : std::nan(""); }), 8.0);
  check(Scan(9, 9, 1.0, 1.0, [](int, int) { return std::nan(""); }), 8.0);
  check(Scan(70, 70, 1.0, 1.0, [](int c, int r) { return c == 9 && r == 9 ? 1e6 : 1e-6 * c; }), 8.0);
  JobControl job;
  const Version field = Scan(20, 20, 1.0, 4.0, [](int c, int) { return c; }).field();
  for (const double wrong : {0.0, -1.0, 7.9, std::numeric_limits<double>::infinity(), std::nan("")})
    EXPECT_EQ(scaleFiltered(field, gaussianOf(wrong), Waves::kLong, job).error().kind, ErrorKind::kInput)
        << wrong;
  job.cancel();
  EXPECT_EQ(scaleFiltered(field, gaussianOf(8.0), Waves::kLong, job).error().kind, ErrorKind::kCancelled);
}

TEST(ScaleFilter, IsBitIdenticalForAnyNumberOfThreads) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise;
  const Version field = Scan(190, 140, 1.0, 2.0, [&](int, int) { return noise(random); }).field();
  const auto with = [&](int threads) {
    std::vector<float> all;
    tbb::task_arena arena(threads);
    arena.execute([&] {
      const Version low = filtered(field, 9.0, Waves::kLong);
      for (int r = 0; r < 140; ++r)
        for (int c = 0; c < 190; ++c) all.push_back(low.reader().heightAt(c, r));
    });
    return all;
  };
  const auto one = with(1);
  for (const int threads : {2, 4}) EXPECT_EQ(with(threads), one);
}

}  // namespace
}  // namespace fettle::engine
