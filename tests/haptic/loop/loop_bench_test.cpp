#include "haptic/loop/loop_bench.h"

#include <gtest/gtest.h>

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
  for (const LoopBenchRow* row : {&report->loop, &report->plain}) {
    // 1,200 periods in two halves; a busy machine starts threads late.
    const std::uint64_t periods = row->lateness.count + row->missed;
    EXPECT_GT(periods, 800U) << row->name;
    EXPECT_LE(row->lateness.p50_ns, row->lateness.p99_ns);
    EXPECT_LE(row->lateness.p9999_ns, row->lateness.worst_ns);
  }
  EXPECT_EQ(report->loop.compute.count, report->loop.lateness.count);
  EXPECT_EQ(report->plain.compute.count, 0U);
  EXPECT_GT(report->events, 10U);
  EXPECT_EQ(report->refused_edits, 0U);
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
