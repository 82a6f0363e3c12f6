#include "engine/transform/resample.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>
#include <glm/geometric.hpp>

#include "engine/field/builder.h"

namespace fettle::engine {
namespace {

using Heights = std::function<double(double, double)>;  // by x, y in lateral units from the first sample
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Version fieldOf(int width, int height, double sx, double sy, const Heights& z,
                const std::function<bool(int, int)>& marked = {}) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  grid.spacing_x = sx;
  grid.spacing_y = sy;
  grid.origin_x = 5e6;
  grid.origin_y = 4e6;
  grid.crs_wkt = "here";
  std::vector<float> heights;
  std::vector<std::uint8_t> marks;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) {
      heights.push_back(static_cast<float>(z(c * sx, r * sy)));
      marks.push_back(marked && marked(c, r));
    }
  return makeField(grid, heights, marks);
}

Version resample(const Version& field, Resampling method, double sx, double sy, double angle = 0.0) {
  JobControl job;
  ResampleOptions options;
  options.method = method;
  options.spacing_x = sx;
  options.spacing_y = sy;
  options.angle_deg = angle;
  auto result = resampled(field, options, job);
  EXPECT_TRUE(result) << result.error().line();
  return result ? *std::move(result) : Version();
}

// Largest difference from z at the world's places, `margin` away from the border of the old field, which was turned by
// `angle` about its middle; and how many heights were compared.
std::pair<double, int> worst(const Version& now, const Grid& old, const Heights& z, double margin,
                             double angle = 0.0) {
  const Grid& grid = now.grid();
  const double a = angle * std::numbers::pi / 180.0;
  const double wide = (old.width - 1) * old.spacing_x, high = (old.height - 1) * old.spacing_y;
  double most = 0.0;
  int compared = 0;
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) {
      const double dx = grid.origin_x - old.origin_x + c * grid.spacing_x - wide / 2.0;
      const double dy = grid.origin_y - old.origin_y + r * grid.spacing_y - high / 2.0;
      const double x = std::cos(a) * dx + std::sin(a) * dy + wide / 2.0;
      const double y = -std::sin(a) * dx + std::cos(a) * dy + high / 2.0;
      if (x < margin || y < margin || x > wide - margin || y > high - margin) continue;
      const auto height = static_cast<double>(now.reader().heightAt(c, r));
      if (std::isnan(height)) return {kNone, 0};
      most = std::max(most, std::abs(height - z(x, y)));
      ++compared;
    }
  return {most, compared};
}

constexpr Resampling kAll[] = {Resampling::kArea, Resampling::kLinear, Resampling::kCubic};

TEST(Resampled, APlaneIsThePlaneByEveryMethodAngleAndSpacing) {
  const auto plane = [](double x, double y) { return 0.5 * x - 0.25 * y + 3.0; };
  for (const Resampling method : kAll)
    for (const auto& [sx, sy] : {std::pair{1.0, 1.0}, {1.0, 4.0}})
      for (const double by : {0.3, 1.0, 1.4, 2.0, 2.5})
        for (const double angle : {0.0, 30.0, -100.0}) {
          const Version field = fieldOf(90, 80, sx, sy, plane);
          const Version now = resample(field, method, by * sx, by * sy, angle);
          const auto [most, compared] = worst(now, field.grid(), plane, 0.0, angle);
          EXPECT_GT(compared, 100);
          // The rounding of heights below 100 to float.
          EXPECT_LT(most, 1e-5) << static_cast<int>(method) << ' ' << sy << ' ' << by << ' ' << angle;
          EXPECT_EQ(now.grid().crs_wkt.empty(), angle != 0.0);
        }
}

// Beyond the outermost samples and beside holes, too: what has a height is on the plane.
TEST(Resampled, APlaneWithHolesIsThePlaneWhereItHasHeights) {
  const auto plane = [](double x, double y) { return 0.5 * x - 0.25 * y + 3.0; };
  std::mt19937 random(4);
  std::vector<bool> missing(90 * 80);
  for (std::size_t i = 0; i < missing.size(); ++i)
    missing[i] = random() % 5 == 0 ||
                 std::hypot(static_cast<double>(i % 90) - 40.0, static_cast<double>(i / 90) - 30.0) < 9.0;
  const Version field = fieldOf(90, 80, 1.0, 1.0, [&](double x, double y) {
    return missing[static_cast<std::size_t>(std::lround(y)) * 90 + static_cast<std::size_t>(std::lround(x))]
               ? kNone
               : plane(x, y);
  });
  for (const Resampling method : kAll)
    for (const double by : {0.3, 1.0, 2.5})
      for (const double angle : {0.0, 20.0}) {
        const Version now = resample(field, method, by, by, angle);
        const Grid& grid = now.grid();
        const double a = angle * std::numbers::pi / 180.0;
        double most = 0.0;
        int heights = 0;
        for (int r = 0; r < grid.height; ++r)
          for (int c = 0; c < grid.width; ++c) {
            const auto height = static_cast<double>(now.reader().heightAt(c, r));
            if (std::isnan(height)) continue;
            const double dx = grid.origin_x - field.grid().origin_x + c * by - 44.5,
                         dy = grid.origin_y - field.grid().origin_y + r * by - 39.5;
            most = std::max(most, std::abs(height - plane(std::cos(a) * dx + std::sin(a) * dy + 44.5,
                                                          -std::sin(a) * dx + std::cos(a) * dy + 39.5)));
            ++heights;
          }
        EXPECT_GT(heights, 500);
        EXPECT_LT(most, 2e-5) << static_cast<int>(method) << ' ' << by << ' ' << angle;
      }
}

TEST(Resampled, CubicIsExactForSquaresAndLinearIsOffByTheirSecondDifference) {
  const auto bowl = [](double x, double y) { return 0.01 * (x * x + 0.5 * y * y); };
  const Version field = fieldOf(60, 60, 1.0, 1.0, bowl);
  for (const double angle : {0.0, 25.0}) {
    EXPECT_LT(
        worst(resample(field, Resampling::kCubic, 0.37, 0.37, angle), field.grid(), bowl, 2.5, angle).first,
        1e-5);
    // h^2 / 8 of each second derivative: (0.02 + 0.01) / 8.
    const double linear =
        worst(resample(field, Resampling::kLinear, 0.37, 0.37, angle), field.grid(), bowl, 2.5, angle).first;
    EXPECT_LT(linear, 0.03 / 8.0 + 1e-5);
    EXPECT_GT(linear, 0.02 / 8.0);
  }
}

TEST(Resampled, OfAWaveTheErrorFallsAsTheLiteratureStates) {
  // Linear: h^2 / 8 of the second derivative, 1 / (8 (wave / 2 pi)^2). Cubic convolution: third order (Keys 1981).
  const auto errorOf = [](Resampling method, double wave) {
    const auto z = [wave](double x, double /*y*/) { return std::sin(2.0 * std::numbers::pi * x / wave); };
    const Version field = fieldOf(200, 8, 1.0, 1.0, z);
    return worst(resample(field, method, 0.31, 1.0), field.grid(), z, 2.5).first;
  };
  const double k = 2.0 * std::numbers::pi / 20.0;
  EXPECT_LT(errorOf(Resampling::kLinear, 20.0), k * k / 8.0);
  EXPECT_NEAR(errorOf(Resampling::kLinear, 20.0) / errorOf(Resampling::kLinear, 40.0), 4.0, 0.3);
  EXPECT_NEAR(errorOf(Resampling::kCubic, 20.0) / errorOf(Resampling::kCubic, 40.0), 8.0, 1.0);
  EXPECT_LT(errorOf(Resampling::kCubic, 20.0), 0.1 * errorOf(Resampling::kLinear, 20.0));
}

TEST(Resampled, ByAreaIsTheMeanOfTheOldCellsMovedToTheNewOnesMiddle) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  std::vector<double> z(70 * 70);
  for (double& v : z) v = random() % 9 == 0 ? kNone : normal(random);
  const Version field = fieldOf(70, 70, 1.0, 1.0, [&](double x, double y) {
    return z[static_cast<std::size_t>(std::lround(y)) * 70 + static_cast<std::size_t>(std::lround(x))];
  });
  for (const double by : {2.0, 2.5, 7.0}) {
    const Version now = resample(field, Resampling::kArea, by, by);
    ASSERT_EQ(now.grid().width, static_cast<int>(70.0 / by));
    EXPECT_EQ(now.grid().origin_x, 5e6 + 0.5 * (by - 1.0));
    for (int r = 0; r < now.grid().height; ++r)
      for (int c = 0; c < now.grid().width; ++c) {
        // The mean, moved to the middle of the new cell along the plane through the samples of a triangle.
        const double x = (c + 0.5) * by - 0.5, y = (r + 0.5) * by - 0.5, half = by + 1.0;
        double sum = 0.0, weights = 0.0, away_x = 0.0, away_y = 0.0;
        double n = 0.0, sx = 0.0, sy = 0.0, sz = 0.0, sxx = 0.0, sxy = 0.0, syy = 0.0, sxz = 0.0, syz = 0.0;
        for (int i = 0; i < 70; ++i)
          for (int k = 0; k < 70; ++k) {
            const double v = static_cast<double>(field.reader().heightAt(k, i));
            if (std::isnan(v)) continue;
            const double w = std::max(0.0, std::min(k + 1.0, (c + 1) * by) - std::max<double>(k, c * by)) *
                             std::max(0.0, std::min(i + 1.0, (r + 1) * by) - std::max<double>(i, r * by));
            sum += w * v;
            weights += w;
            away_x += w * (k - x);
            away_y += w * (i - y);
            const double t =
                std::max(0.0, 1.0 - std::abs(k - x) / half) * std::max(0.0, 1.0 - std::abs(i - y) / half);
            n += t, sx += t * (k - x), sy += t * (i - y), sz += t * v;
            sxx += t * (k - x) * (k - x), sxy += t * (k - x) * (i - y), syy += t * (i - y) * (i - y);
            sxz += t * (k - x) * v, syz += t * (i - y) * v;
          }
        const double xx = sxx - sx * sx / n, xy = sxy - sx * sy / n, yy = syy - sy * sy / n;
        const double xz = sxz - sx * sz / n, yz = syz - sy * sz / n, det = xx * yy - xy * xy;
        const double moved =
            (sum - (away_x * (yy * xz - xy * yz) + away_y * (xx * yz - xy * xz)) / det) / weights;
        const float got = now.reader().heightAt(c, r);
        ASSERT_EQ(std::isnan(got), weights < 0.5 * by * by - 1e-9);
        if (!std::isnan(got)) {
          ASSERT_NEAR(static_cast<double>(got), moved, 2e-6);
        }
      }
  }
}

TEST(Resampled, ByAreaACellIsAHoleWhereLessThanHalfOfItIsKnown) {
  // 16 old samples in each cell, in the middle between four of them.
  const auto holesOf = [](const std::function<bool(int, int)>& hole, int side = 240) {
    const Version field = fieldOf(side, side, 1.0, 1.0, [&](double x, double y) {
      return hole(static_cast<int>(x), static_cast<int>(y)) ? kNone : 2.0 + 0.01 * x - 0.02 * y;
    });
    const Version now = resample(field, Resampling::kArea, 4.0, 4.0);
    for (int r = 0; r < now.grid().height; ++r)
      for (int c = 0; c < now.grid().width; ++c)
        if (const float z = now.reader().heightAt(c, r); !std::isnan(z)) {
          EXPECT_NEAR(static_cast<double>(z), 2.0 + 0.01 * (4 * c + 1.5) - 0.02 * (4 * r + 1.5), 1e-6);
        }
    return static_cast<int>(summarize(now).no_data);
  };
  // Single holes make none, wherever they lie in their cells.
  for (int k = 0; k < 16; ++k)
    EXPECT_EQ(holesOf([&](int c, int r) { return c % 4 == k % 4 && r % 4 == k / 4; }), 0) << k;
  // Half of it is enough, less is not; nor is the sample in the middle alone.
  EXPECT_EQ(holesOf([](int c, int) { return c % 4 < 2; }), 0);
  EXPECT_EQ(holesOf([](int c, int r) { return c % 4 < 2 || (c % 4 == 2 && r % 4 == 0); }), 60 * 60);
  EXPECT_EQ(holesOf([](int c, int r) { return c % 4 != 2 || r % 4 != 2; }), 60 * 60);
  EXPECT_EQ(holesOf([](int, int) { return true; }), 60 * 60);
  // A round hole keeps its size: no known cell is needed beside it, and none is made up in it.
  const auto round = [](int c, int r) { return std::hypot(c - 119.0, r - 122.0) < 70.0; };
  EXPECT_NEAR(16.0 * holesOf(round) / (std::numbers::pi * 70.0 * 70.0), 1.0, 0.01);
  // What lies beyond the border is no part of the cell: of a field smaller than it all counts.
  const Version small =
      fieldOf(3, 2, 1.0, 1.0, [](double x, double y) { return x == 0.0 && y == 0.0 ? kNone : x; });
  EXPECT_NEAR(static_cast<double>(resample(small, Resampling::kArea, 9.0, 9.0).reader().heightAt(0, 0)), 1.0,
              1e-6);
}

TEST(Resampled, ByOtherMethodsTheNearestSampleDecidesAtAnySpacing) {
  const auto single = [](double x, double y) { return x == 13.0 && y == 9.0 ? kNone : 1.0; };
  const Version field = fieldOf(40, 30, 1.0, 1.0, single);
  for (const Resampling method : {Resampling::kLinear, Resampling::kCubic})
    for (const double by : {0.25, 0.5, 1.0, 3.0, 4.0}) {
      const Version now = resample(field, method, by, by);
      for (int r = 0; r < now.grid().height; ++r)
        for (int c = 0; c < now.grid().width; ++c)
          ASSERT_EQ(std::isnan(now.reader().heightAt(c, r)),
                    std::floor(c * by + 0.5) == 13.0 && std::floor(r * by + 0.5) == 9.0)
              << by << ' ' << c << ' ' << r;
    }
}

TEST(Resampled, WavesFinerThanTheNewSpacingAreAveragedNotFolded) {
  // Waves of 2.2 samples at a spacing of 4: taken as they are they fold into ones of 22 with their whole height.
  const auto wave = [](double x, double /*y*/) { return std::sin(2.0 * std::numbers::pi * x / 2.2); };
  const Version field = fieldOf(400, 40, 1.0, 1.0, wave);
  double folded = 0.0;
  for (int c = 0; c < 400; c += 4) folded = std::max(folded, std::abs(wave(c, 0.0)));
  EXPECT_GT(folded, 0.95);
  const auto none = [](double, double) { return 0.0; };
  // What a mean of four samples leaves of such a wave, |sin(4 a) / (4 sin(a))| with a = pi / 2.2; the triangle is the mean
  // of means.
  const double a = std::numbers::pi / 2.2, box = std::abs(std::sin(4.0 * a) / (4.0 * std::sin(a)));
  EXPECT_LT(worst(resample(field, Resampling::kArea, 4.0, 4.0), field.grid(), none, 8.0).first, 1.001 * box);
  EXPECT_LT(worst(resample(field, Resampling::kLinear, 4.0, 4.0), field.grid(), none, 8.0).first,
            1.001 * box * box);
  EXPECT_LT(worst(resample(field, Resampling::kCubic, 4.0, 4.0), field.grid(), none, 8.0).first, box);
}

TEST(Resampled, HolesMarksAndLinesGoAlong) {
  const auto hole = [](double x, double y) {
    return std::hypot(x - 30.0, y - 20.0) < 6.0 ? kNone : 1.0 + 0.1 * x;
  };
  const auto marked = [](int c, int r) { return c == 45 && r > 5; };
  Version field = fieldOf(60, 40, 1.0, 1.0, hole, marked);
  EdgeLine line;
  for (int i = 0; i < 30; ++i) {
    EdgePoint p;
    p.position = {10.0 + i, 8.0};
    p.located = true;
    p.deviation = 0.2;
    p.step = 3.0;
    p.slope_change = 0.6;
    line.points.push_back(p);
  }
  field = field.withLines(std::make_shared<const std::vector<EdgeLine>>(1, line));
  for (const Resampling method : kAll) {
    const Version fine = resample(field, method, 0.25, 0.5);
    for (int r = 0; r < fine.grid().height; ++r)
      for (int c = 0; c < fine.grid().width; ++c) {
        const double x = (fine.grid().origin_x - 5e6 + 0.25 * c), y = fine.grid().origin_y - 4e6 + 0.5 * r;
        const int nc = static_cast<int>(std::floor(x + 0.5)), nr = static_cast<int>(std::floor(y + 0.5));
        ASSERT_EQ(std::isnan(fine.reader().heightAt(c, r)), std::isnan(field.reader().heightAt(nc, nr)));
        if (std::abs(x - nc) < 0.49 && std::abs(y - nr) < 0.49) {
          ASSERT_EQ(fine.reader().markedAt(c, r), marked(nc, nr));
        }
      }
    const EdgeLine& moved = fine.lines()->front();
    const double first_x = (fine.grid().origin_x - 5e6) / 0.25, first_y = (fine.grid().origin_y - 4e6) / 0.5;
    EXPECT_NEAR(moved.points.front().position.x, 40.0 - first_x, 1e-5);
    EXPECT_NEAR(moved.points.front().position.y, 16.0 - first_y, 1e-5);
    EXPECT_NEAR(moved.points.front().deviation, 0.4,
                1e-9);  // across: along the columns, two new samples in an old one
    EXPECT_NEAR(moved.points.front().slope_change, 0.3, 1e-9);
    EXPECT_EQ(moved.points.front().step, 3.0);
    for (std::size_t i = 1; i < moved.points.size(); ++i)
      EXPECT_LE(glm::distance(moved.points[i].position, moved.points[i - 1].position), EdgeLine::kMostApart);
    // Marks of one sample's width are still there at twice the spacing.
    const Version coarse = resample(field, method, 2.0, 2.0);
    int rows = 0;
    for (int r = 0; r < coarse.grid().height; ++r)
      for (int c = 0; c < coarse.grid().width; ++c)
        if (coarse.reader().markedAt(c, r)) {
          ++rows;
          break;
        }
    EXPECT_GE(rows, 16);
  }
  // Turned: a point of the line is where the height that it was drawn on is.
  const Version turned = resample(field, Resampling::kCubic, 1.0, 1.0, 30.0);
  const glm::dvec2 p = turned.lines()->front().points[10].position;
  const double a = std::numbers::pi / 6.0, dx = 20.0 - 29.5, dy = 8.0 - 19.5;
  EXPECT_NEAR(p.x, std::cos(a) * dx - std::sin(a) * dy + 0.5 * (turned.grid().width - 1), 1e-5);
  EXPECT_NEAR(p.y, std::sin(a) * dx + std::cos(a) * dy + 0.5 * (turned.grid().height - 1), 1e-5);
}

TEST(Resampled, OneRowOneSampleAndFarHeightsWork) {
  for (const Resampling method : kAll) {
    const Version row = fieldOf(40, 1, 1.0, 1.0, [](double x, double) { return 5e6 + x; });
    const Version now = resample(row, method, 2.0, 1.0);
    EXPECT_EQ(now.grid().height, 1);
    EXPECT_EQ(summarize(now).no_data, 0);
    EXPECT_NEAR(static_cast<double>(now.reader().heightAt(5, 0)), 5e6 + 10.0, 1.0);
    EXPECT_EQ(summarize(resample(row, method, 1.0, 1.0, 45.0)).no_data < 60 * 60, true);
    const Version one = fieldOf(1, 1, 1.0, 1.0, [](double, double) { return 7.0; });
    EXPECT_EQ(resample(one, method, 3.0, 3.0).reader().heightAt(0, 0), 7.0F);
  }
}

TEST(Resampled, IsTheSameForAnyNumberOfThreadsIsRefusedAndCancelled) {
  const Version field =
      fieldOf(300, 200, 1.0, 1.0, [](double x, double y) { return std::sin(x) + std::cos(0.1 * x * y); });
  std::uint64_t one = 0, four = 0;
  tbb::task_arena(1).execute([&] { one = contentHash(resample(field, Resampling::kCubic, 1.3, 0.7, 17.0)); });
  tbb::task_arena(4).execute(
      [&] { four = contentHash(resample(field, Resampling::kCubic, 1.3, 0.7, 17.0)); });
  EXPECT_EQ(one, four);
  JobControl job;
  ResampleOptions options;
  options.spacing_x = options.spacing_y = 300.0;
  EXPECT_EQ(resampled(field, options, job).error().kind, ErrorKind::kInput);
  options.spacing_x = options.spacing_y = 1e-4;
  EXPECT_EQ(resampled(field, options, job).error().kind, ErrorKind::kInput);
  options.spacing_x = options.spacing_y = 1.0;
  job.cancel();
  EXPECT_EQ(resampled(field, options, job).error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::engine
