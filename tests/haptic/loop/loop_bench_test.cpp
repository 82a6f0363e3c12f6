#include "haptic/loop/loop_bench.h"

#include <cstdlib>

#include <gtest/gtest.h>

#include "haptic/loop/cyclictest.h"

namespace fettle::haptic {
namespace {

TEST(LoopBench, CountsEveryPeriodOnceAsATickOrAsMissed) {
  engine::JobControl job;
  LoopBenchOptions options;
  options.seconds = 0.6;
  options.rate_hz = 2000.0;
  options.priority = 0;
  const auto report = benchLoop(options, job);
  ASSERT_TRUE(report) << report.error().line();
  for (const LoopBenchRow* row : {&report->loop, &report->reference}) {
    // 1,200 periods in two halves; a busy machine starts threads late.
    const std::uint64_t periods = row->lateness.count + row->missed;
    EXPECT_GT(periods, 800U) << row->name;
    EXPECT_LE(row->lateness.p50_ns, row->lateness.p99_ns);
    EXPECT_LE(row->lateness.p9999_ns, row->lateness.worst_ns);
  }
  EXPECT_EQ(report->loop.compute.count, report->loop.lateness.count);
  EXPECT_EQ(report->reference.compute.count, 0U);
  EXPECT_GT(report->events, 10U);
  EXPECT_EQ(report->refused_edits, 0U);
}

TEST(LoopBench, CyclictestsHistogramIsReadWithWhatLiesBeyondIt) {
  TimingHistogram h;
  ASSERT_TRUE(
      addCyclictestHistogram("# /dev/cpu_dma_latency set to 0us\n# Histogram\n000003 000002\n"
                             "000040 000001\n# Total: 000000003\n# Max Latencies: 25000\n"
                             "# Histogram Overflows: 00001\n",
                             h));
  const TimingFigures f = h.figures();
  EXPECT_EQ(f.count, 4U);
  EXPECT_EQ(f.worst_ns, 25'000'000);
  EXPECT_EQ(h.countAbove(1'000'000), 1U);
  EXPECT_NEAR(static_cast<double>(f.p50_ns), 3000.0, 3000.0 / 32);
  TimingHistogram none;
  EXPECT_FALSE(addCyclictestHistogram("Unable to change scheduling policy!\n", none));
  EXPECT_FALSE(addCyclictestHistogram("", none));
}

TEST(LoopBench, MeasuresBesideCyclictestWhereItIsInstalledAndSaysWhereItIsNot) {
  if (!Cyclictest::installed()) GTEST_SKIP() << "cyclictest (rt-tests) is not installed";
  engine::JobControl job;
  const auto report = benchLoop({.seconds = 1.4, .load = BenchLoad::kBusy, .priority = 0}, job);
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_EQ(report->no_cyclictest, "");
  EXPECT_EQ(report->reference.name, "cyclictest");
  EXPECT_EQ(report->reference.lateness.count, 1400U);
  const auto brief = benchLoop({.seconds = 0.2, .priority = 0}, job);
  ASSERT_TRUE(brief);
  EXPECT_NE(brief->no_cyclictest, "");
  EXPECT_EQ(brief->reference.name, "plain thread");
}

TEST(LoopBench, DrivesADeviceThatIsNamedAndSaysWhereNothingComesFromIt) {
  engine::JobControl job;
  const auto report = benchLoop({.seconds = 0.4, .priority = 0, .device = "hand"}, job);
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_EQ(report->loop.name, "haptic loop, hand");
  EXPECT_GT(report->loop.lateness.count, 100U);
  setenv("FETTLE_INVERSE3", "localhost:1", 1);  // nobody answers there
  EXPECT_EQ(benchLoop({.seconds = 0.1, .priority = 0, .device = "inverse3"}, job).error().kind,
            engine::ErrorKind::kFailed);
  EXPECT_EQ(benchLoop({.device = "anvil"}, job).error().kind, engine::ErrorKind::kInput);
}

TEST(LoopBench, RefusesWhatIsOutOfRangeAndStopsWhenAskedTo) {
  engine::JobControl job;
  EXPECT_EQ(benchLoop({.seconds = -1.0}, job).error().kind, engine::ErrorKind::kInput);
  EXPECT_EQ(benchLoop({.rate_hz = 10.0}, job).error().kind, engine::ErrorKind::kInput);
  EXPECT_EQ(benchLoop({.priority = 100}, job).error().kind, engine::ErrorKind::kInput);
  job.cancel();
  EXPECT_EQ(benchLoop({.seconds = 60.0}, job).error().kind, engine::ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::haptic
