// What the benchmark of measuring prints is about the step that the row names.
#include "bench/measure_bench.h"

#include <map>
#include <string>

#include <gtest/gtest.h>

namespace fettle::bench {
namespace {

TEST(MeasureBench, HasARowForEachStepWithItsTimeBesideThatOfCopying) {
  MeasureBenchOptions options;
  options.side = 512;
  options.repeats = 2;
  engine::JobControl job;
  const auto report = benchMeasure(options, job);
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_EQ(report->samples, 512 * 512);
  std::map<std::uint64_t, std::string> steps;
  for (const MeasureBenchRow& row : report->rows) {
    SCOPED_TRACE(row.step);
    EXPECT_GT(row.fastest, 0.0);
    EXPECT_LE(row.fastest, row.median);
    EXPECT_LE(row.median, row.slowest);
    EXPECT_GT(row.plain, 0.0);
    // Each step makes another field, or finds other figures.
    EXPECT_TRUE(steps.emplace(row.bits, row.step).second) << steps[row.bits];
  }
  ASSERT_EQ(report->rows.size(), 15U);
  EXPECT_EQ(report->rows[13].step, "remove above 2 mm");
  EXPECT_EQ(report->rows[14].step, "remove marked rows");
}

TEST(MeasureBench, RefusesOptionsOutOfRange) {
  engine::JobControl job;
  EXPECT_FALSE(benchMeasure({.side = 511}, job));
  EXPECT_FALSE(benchMeasure({.side = 512, .repeats = 0}, job));
}

}  // namespace
}  // namespace fettle::bench
