// Costs over work: the slopes are those of the points, and every series has all its sizes.
#include "bench/growth_bench.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/commit_times.h"
#include "haptic/trials/hand_stroke.h"

namespace fettle::bench {
namespace {

TEST(GrowthBench, SlopeIsThatOfThePower) {
  for (const double power : {0.0, 1.0, 2.0, -0.5}) {
    std::vector<GrowthPoint> points;
    for (const double work : {3.0, 17.0, 1000.0}) points.push_back({work, 5.0 * std::pow(work, power), 0.0});
    EXPECT_NEAR(slopeOf(points), power, 1e-12);
  }
  EXPECT_EQ(slopeOf({}), 0.0);
  EXPECT_EQ(slopeOf({{4.0, 2.0, 2.0}}), 0.0);
}

TEST(GrowthBench, EverySeriesHasAllItsSizes) {
  GrowthOptions options;
  options.largest = 512;
  options.effort = 0.02;
  options.picture = false;
  engine::JobControl job;
  const auto report = benchGrowth(options, job);
  ASSERT_TRUE(report) << report.error().line();
  ASSERT_EQ(report->growths.size(), 6U);
  for (const Growth& growth : report->growths) {
    EXPECT_FALSE(growth.series.empty()) << growth.id;
    const std::size_t sizes = growth.series.front().points.size();
    EXPECT_GE(sizes, 2U) << growth.id;
    for (const GrowthSeries& series : growth.series) {
      EXPECT_EQ(series.points.size(), sizes) << series.name;
      for (const GrowthPoint& p : series.points) {
        EXPECT_GT(p.median, 0.0) << series.name;
        EXPECT_LE(p.median, p.worst) << series.name;
      }
    }
  }
  EXPECT_EQ(job.done(), job.total());
}

TEST(GrowthBench, EveryStrokeIsTimedUntilItIsOnTheDisk) {
  engine::JobControl job;
  const auto times = commitTimes(trials::workpiece(256, 0.05), 4, job);
  ASSERT_TRUE(times) << times.error().line();
  ASSERT_EQ(times->durable_ms.size(), 4U);
  ASSERT_EQ(times->waits_ms.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_GT(times->waits_ms[i], 0.0);
    EXPECT_GT(times->durable_ms[i], times->waits_ms[i]);
    EXPECT_GT(times->tiles[i], 0.0);
    EXPECT_LE(times->tiles[i], 16.0);
  }
}

TEST(GrowthBench, AFieldOutOfRangeIsRefusedAndACancelIsHeard) {
  engine::JobControl job;
  GrowthOptions options;
  options.largest = 200;
  EXPECT_EQ(benchGrowth(options, job).error().kind, engine::ErrorKind::kInput);
  options.largest = 256;
  job.cancel();
  EXPECT_EQ(benchGrowth(options, job).error().kind, engine::ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::bench
