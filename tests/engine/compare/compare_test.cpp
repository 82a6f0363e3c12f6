#include "engine/compare/compare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "engine/field/builder.h"
#include "tests/support/no_data.h"

namespace fettle::engine {
namespace {

Grid gridOf(int width, int height) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  return grid;
}

Deviation compared(const Version& a, const Version& b) {
  JobControl job;
  Result<Deviation> d = compareFields(a, b, job);
  if (!d) throw std::runtime_error(d.error().line());
  return *d;
}

// The same figures in long double, with a solver of its own and a sorted copy.
struct Reference {
  long double rms = 0, mean = 0, max_abs = 0, p99 = 0, sq_a = 0, sa_a = 0;
};
Reference reference(const std::vector<float>& a, const std::vector<float>& b, int width) {
  Reference ref;
  std::vector<long double> d;
  long double n = 0, c = 0, r = 0, z = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!std::isnan(a[i]) && !std::isnan(b[i])) d.push_back((long double)b[i] - (long double)a[i]);
    if (std::isnan(a[i])) continue;
    n += 1;
    c += i % static_cast<std::size_t>(width);
    r += i / static_cast<std::size_t>(width);
    z += (long double)a[i];
  }
  for (const long double x : d) {
    ref.mean += x / d.size();
    ref.rms += x * x / d.size();
    ref.max_abs = std::max(ref.max_abs, std::abs(x));
  }
  ref.rms = std::sqrt(ref.rms);
  for (long double& x : d) x = std::abs(x);
  std::sort(d.begin(), d.end());
  ref.p99 = d[(99 * d.size() + 99) / 100 - 1];
  c /= n, r /= n, z /= n;
  long double cc = 0, cr = 0, rr = 0, cz = 0, rz = 0;
  const auto eachA = [&](auto&& f) {
    for (std::size_t i = 0; i < a.size(); ++i)
      if (!std::isnan(a[i]))
        f(i % static_cast<std::size_t>(width) - c, i / static_cast<std::size_t>(width) - r,
          (long double)a[i] - z);
  };
  eachA([&](long double x, long double y, long double h) {
    cc += x * x, cr += x * y, rr += y * y, cz += x * h, rz += y * h;
  });
  const long double det = cc * rr - cr * cr;
  const long double gx = (rr * cz - cr * rz) / det;
  const long double gy = (cc * rz - cr * cz) / det;
  eachA([&](long double x, long double y, long double h) {
    const long double e = h - gx * x - gy * y;
    ref.sq_a += e * e / n;
    ref.sa_a += std::abs(e) / n;
  });
  ref.sq_a = std::sqrt(ref.sq_a);
  return ref;
}

std::vector<float> someHeights(int n, unsigned seed, double offset, double size, unsigned hole_one_in) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(offset, size);
  std::vector<float> z;
  for (int i = 0; i < n; ++i)
    z.push_back(hole_one_in != 0 && random() % hole_one_in == 0 ? kNan : static_cast<float>(normal(random)));
  return z;
}

TEST(Compare, EqualsALongDoubleReferenceAtAnyOffsetAndSize) {
  for (const auto& [offset, size] : {std::pair{0.0, 1.0}, {5e6, 0.3}, {-3e-41, 1e-41}, {1e30, 1e29}})
    for (const auto& [w, h] : {std::pair{150, 131}, {65, 3}, {2, 2}}) {
      const auto a = someHeights(w * h, 1, offset, size, w > 2 ? 9 : 0);
      const auto b = someHeights(w * h, 2, offset, size, w > 2 ? 7 : 0);
      const Deviation d = compared(makeField(gridOf(w, h), a), makeField(gridOf(w, h), b));
      const Reference ref = reference(a, b, w);
      // Compensated sums leave two roundings of the largest addend; means, squares and the root a few more,
      // of the largest height: 32 of them are ample.
      const double eps = 32 * std::numeric_limits<double>::epsilon() * (std::abs(offset) + 5.0 * size);
      EXPECT_NEAR(d.rms, static_cast<double>(ref.rms), eps);
      EXPECT_NEAR(d.mean, static_cast<double>(ref.mean), eps);
      EXPECT_EQ(d.max_abs, static_cast<double>(ref.max_abs));
      EXPECT_EQ(d.p99, static_cast<double>(ref.p99));
      EXPECT_NEAR(d.sq_a, static_cast<double>(ref.sq_a), eps);
      EXPECT_NEAR(d.sa_a, static_cast<double>(ref.sa_a), eps);
    }
}

TEST(Compare, ConstantOffsetIsTheMeanTheRmsTheMaximumAndThe99thPercentile) {
  const auto a = someHeights(70 * 66, 3, 0.0, 4.0, 0);
  std::vector<float> a8;
  std::vector<float> b;
  for (const float z : a) {
    a8.push_back(std::round(z * 8.0F) / 8.0F);  // so that adding 0.5 is exact
    b.push_back(a8.back() + 0.5F);
  }
  const Deviation d = compared(makeField(gridOf(70, 66), a8), makeField(gridOf(70, 66), b));
  EXPECT_EQ(d.mean, 0.5);
  EXPECT_EQ(d.rms, 0.5);
  EXPECT_EQ(d.max_abs, 0.5);
  EXPECT_EQ(d.p99, 0.5);
  EXPECT_NEAR(d.sq_a, d.sq_b, 1e-14);
  EXPECT_NEAR(d.sa_a, d.sa_b, 1e-14);
}

TEST(Compare, IsBMinusA) {
  const Deviation d = compared(makeField(gridOf(2, 1), {1, 1}), makeField(gridOf(2, 1), {0, 1}));
  EXPECT_EQ(d.mean, -0.5);
}

TEST(Compare, OneSpikeOfAMillionIsInTheMaximumAndNotInThePercentile) {
  std::vector<float> b(200 * 100, 0.0F);
  b[777] = 1e6F;
  const Deviation d = compared(makeField(gridOf(200, 100), std::vector<float>(b.size(), 0.0F)),
                               makeField(gridOf(200, 100), b));
  EXPECT_EQ(d.max_abs, 1e6);
  EXPECT_EQ(d.p99, 0.0);
  EXPECT_DOUBLE_EQ(d.rms, 1e6 / std::sqrt(20000.0));
  EXPECT_DOUBLE_EQ(d.mean, 50.0);
}

TEST(Compare, PercentileIsTheNearestRankForEverySmallCount) {
  for (int n = 1; n <= 205; ++n) {
    std::vector<float> b;
    for (int i = 0; i < n; ++i) b.push_back(static_cast<float>((i * 37) % n) * (i % 2 == 0 ? 1.0F : -1.0F));
    std::vector<double> sorted;
    for (const float z : b) sorted.push_back(std::abs(static_cast<double>(z)));
    std::sort(sorted.begin(), sorted.end());
    const Deviation d =
        compared(makeField(gridOf(n, 1), std::vector<float>(b.size(), 0.0F)), makeField(gridOf(n, 1), b));
    const auto within = std::count_if(sorted.begin(), sorted.end(), [&](double x) { return x <= d.p99; });
    const auto below = std::count_if(sorted.begin(), sorted.end(), [&](double x) { return x < d.p99; });
    EXPECT_GE(100 * within, 99 * n);
    EXPECT_LT(100 * below, 99 * n);
  }
}

TEST(Compare, HolesAreCountedBySideAndLeftOut) {
  const Deviation d = compared(makeField(gridOf(5, 1), {1, kNan, 3, kNan, 5}),
                               makeField(gridOf(5, 1), {2, 2, kNan, kNan, 7}));
  EXPECT_EQ(d.samples, 2);
  EXPECT_EQ(d.only_a, 1);
  EXPECT_EQ(d.only_b, 1);
  EXPECT_EQ(d.mean, 1.5);
  EXPECT_EQ(d.max_abs, 2.0);
}

TEST(Compare, OfNothingInCommonIsNanAndNoCrash) {
  const Deviation d = compared(makeField(gridOf(2, 1), {1, kNan}), makeField(gridOf(2, 1), {kNan, 1}));
  EXPECT_EQ(d.samples, 0);
  EXPECT_TRUE(std::isnan(d.rms) && std::isnan(d.mean) && std::isnan(d.max_abs) && std::isnan(d.p99));
  EXPECT_EQ(d.sq_a, 0.0);  // one sample lies on its own plane
  const Version holes = makeField(gridOf(2, 1), {kNan, kNan});
  EXPECT_TRUE(std::isnan(compared(holes, holes).sq_a));
}

TEST(Compare, RoughnessOfATiltedPlaneIsNoneAndOfAWaveTheKnownOne) {
  const int n = 256;
  std::vector<float> plane;
  std::vector<float> wave;
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; ++c) {
      plane.push_back(0.25F * static_cast<float>(c) - 0.5F * static_cast<float>(r) + 5e6F);
      wave.push_back(c % 2 == 0 ? 1.0F : -1.0F);
    }
  const Deviation d = compared(makeField(gridOf(n, n), plane), makeField(gridOf(n, n), wave));
  // 5e6 needs 23 bits: the plane's quarters are not all floats; half an ulp of 5e6 is 0.25.
  EXPECT_LE(d.sq_a, 0.25);
  // A row of +1, -1, ...: its plane tilts by 6 / (n (n^2 - 1)) * n / 2 a column, which takes 3 / (n^2 - 1) of
  // the mean square.
  EXPECT_NEAR(d.sq_b, 1.0 - 1.5 / (n * n - 1.0), 1e-9);
  EXPECT_NEAR(d.sa_b, 1.0, 1e-4);
}

TEST(Compare, OneRowOneColumnAndOneSampleAreLevelled) {
  std::vector<float> line;
  for (int i = 0; i < 100; ++i) line.push_back(3.0F + 0.5F * static_cast<float>(i));
  for (const Grid& grid : {gridOf(100, 1), gridOf(1, 100)}) {
    const Deviation d = compared(makeField(grid, line), makeField(grid, line));
    EXPECT_NEAR(d.sq_a, 0.0, 1e-13);
    EXPECT_EQ(d.rms, 0.0);
  }
  EXPECT_EQ(compared(makeField(gridOf(1, 1), {4}), makeField(gridOf(1, 1), {7})).rms, 3.0);
}

TEST(Compare, SamplesOnOneSlantedLineAreLevelledAlongIt) {
  std::vector<float> z(50 * 50, kNan);
  for (int i = 0; i < 50; ++i) z[static_cast<std::size_t>(i * 50 + i)] = static_cast<float>(i);
  const Version v = makeField(gridOf(50, 50), z);
  EXPECT_NEAR(compared(v, v).sq_a, 0.0, 1e-12);
}

TEST(Compare, TakesTheSignAndTheUnitOfEachField) {
  Grid metres = gridOf(2, 1);
  metres.height_unit = {"m", 1000.0};
  const Version mm = makeField(gridOf(2, 1), {1000, 2000});
  const Version m = makeField(metres, {1, 2});
  EXPECT_EQ(compared(mm, m).max_abs, 0.0);
  EXPECT_DOUBLE_EQ(compared(m, mm.inverted()).max_abs, 4.0);
}

TEST(Compare, GivesTheSameBitsForAnyNumberOfThreads) {
  const auto a = someHeights(500 * 400, 5, 10.0, 1.0, 11);
  const auto b = someHeights(500 * 400, 6, 10.0, 1.0, 13);
  const Version va = makeField(gridOf(500, 400), a);
  const Version vb = makeField(gridOf(500, 400), b);
  const Deviation one = compared(va, vb);
  for (const std::size_t threads : {1, 3, 8}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Deviation d = compared(va, vb);
    EXPECT_EQ(d.rms, one.rms);
    EXPECT_EQ(d.mean, one.mean);
    EXPECT_EQ(d.p99, one.p99);
    EXPECT_EQ(d.sq_a, one.sq_a);
    EXPECT_EQ(d.sa_b, one.sa_b);
  }
}

TEST(Compare, RefusesUnlikeSizesAndStopsWhenCancelled) {
  JobControl job;
  const Version a = makeField(gridOf(2, 1), {1, 2});
  const auto unlike = compareFields(a, makeField(gridOf(1, 2), {1, 2}), job);
  ASSERT_FALSE(unlike);
  EXPECT_EQ(unlike.error().kind, ErrorKind::kInput);
  job.cancel();
  const auto stopped = compareFields(a, a, job);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::engine
