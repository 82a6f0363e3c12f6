// The loop's parts, each alone: ring, histogram, schedule, real-time scope, merge of a job's result.

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/stopwatch.h"
#include "engine/field/difference.h"
#include "engine/field/live_field.h"
#include "haptic/base/rings.h"
#include "haptic/base/rt_thread.h"
#include "haptic/loop/adopt_filtered.h"
#include "haptic/loop/pacer.h"
#include "haptic/loop/timing.h"
#include "tests/haptic/support/fields.h"

namespace fettle::haptic {
namespace {

TEST(SpscRing, GivesBackInOrderAndRefusesWhenFull) {
  SpscRing<std::unique_ptr<int>> ring(4);
  std::unique_ptr<int> out;
  EXPECT_FALSE(ring.pop(out));
  for (int round = 0; round < 5; ++round) {
    for (int i = 0; i < 4; ++i) EXPECT_TRUE(ring.push(std::make_unique<int>(i)));
    auto fifth = std::make_unique<int>(4);
    EXPECT_FALSE(ring.push(std::move(fifth)));
    EXPECT_NE(fifth, nullptr);  // a refused record stays with its owner
    EXPECT_EQ(ring.freePlaces(), 0U);
    for (int i = 0; i < 4; ++i) {
      ASSERT_TRUE(ring.pop(out));
      EXPECT_EQ(*out, i);
    }
    EXPECT_EQ(ring.freePlaces(), 4U);
  }
}

TEST(SpscRing, PoppedRecordLeavesNothingBehind) {
  SpscRing<std::shared_ptr<int>> ring(2);
  auto value = std::make_shared<int>(1);
  ASSERT_TRUE(ring.push(std::shared_ptr<int>(value)));
  {
    std::shared_ptr<int> out;
    ASSERT_TRUE(ring.pop(out));
  }
  EXPECT_EQ(value.use_count(), 1);
}

TEST(TimingHistogram, PercentilesAreThoseOfASortedListWithinOneThirtySecond) {
  std::mt19937_64 random(7);
  TimingHistogram histogram;
  std::vector<std::int64_t> all;
  for (int i = 0; i < 100000; ++i) {
    const double u = static_cast<double>(random() >> 11) * 0x1p-53;
    const auto ns = static_cast<std::int64_t>(std::exp(2.0 + 14.0 * u * u));
    all.push_back(ns);
    histogram.add(ns);
  }
  std::sort(all.begin(), all.end());
  const TimingFigures f = histogram.figures();
  const auto exact = [&](double share) {
    return all[static_cast<std::size_t>(std::ceil(share * static_cast<double>(all.size()))) - 1];
  };
  const auto near = [](std::int64_t got, std::int64_t want) {
    EXPECT_GE(got, want);
    EXPECT_LE(static_cast<double>(got), static_cast<double>(want) * (1.0 + 1.0 / 32.0) + 1.0);
  };
  near(f.p50_ns, exact(0.5));
  near(f.p99_ns, exact(0.99));
  near(f.p999_ns, exact(0.999));
  near(f.p9999_ns, exact(0.9999));
  EXPECT_EQ(f.worst_ns, all.back());
  EXPECT_EQ(f.count, all.size());
}

TEST(TimingHistogram, ExtremesAndNothingAreFine) {
  TimingHistogram histogram;
  EXPECT_EQ(histogram.figures(), TimingFigures{});
  histogram.add(-5);
  EXPECT_EQ(histogram.figures().worst_ns, 0);
  histogram.add(std::numeric_limits<std::int64_t>::max());
  const TimingFigures f = histogram.figures();
  EXPECT_EQ(f.worst_ns, std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(f.p50_ns, 0);
  EXPECT_EQ(histogram.countAbove(1000), 1U);
}

TEST(Schedule, LateTicksAreSkippedAndNeverBunched) {
  Schedule schedule(1000, 100);
  EXPECT_EQ(schedule.wake(1003).lateness_ns, 3);
  EXPECT_EQ(schedule.due(), 1100);
  // 3.5 periods late: three ticks are gone, the next is due on the old grid.
  const Schedule::Wake wake = schedule.wake(1450);
  EXPECT_EQ(wake.lateness_ns, 350);
  EXPECT_EQ(wake.skipped, 3);
  EXPECT_EQ(schedule.due(), 1500);
  // A clock that is early (it can not be) counts as on time.
  EXPECT_EQ(schedule.wake(1490).lateness_ns, 0);
}

TEST(Schedule, NoPeriodHasTwoTicksHoweverTheyAreDelayed) {
  std::mt19937_64 random(3);
  Schedule schedule(0, 1000);
  std::int64_t now = 0;
  std::int64_t ticks = 0;
  std::int64_t skipped = 0;
  std::int64_t last_period = -1;
  for (int i = 0; i < 100000; ++i) {
    now = std::max(now, schedule.due());  // sleeps
    now += static_cast<std::int64_t>(random() % 100 == 0 ? random() % 9000 : random() % 300);
    skipped += schedule.wake(now).skipped;
    ++ticks;
    ASSERT_GT(now / 1000, last_period);
    last_period = now / 1000;
    now += 200;  // works
  }
  EXPECT_EQ(ticks + skipped, schedule.due() / 1000);
  EXPECT_GT(skipped, 0);
}

TEST(Pacer, KeepsTheRateAndHoldsItToItsRange) {
  EXPECT_EQ(Pacer(1e9).period(), 100000);
  EXPECT_EQ(Pacer(1.0).period(), 1000000);
  EXPECT_EQ(Pacer(std::numeric_limits<double>::quiet_NaN()).period(), 1000000);
  Pacer pacer(2000.0);
  const engine::Stopwatch watch;
  std::int64_t periods = 0;
  for (int i = 0; i < 200; ++i) {
    const Pacer::Tick tick = pacer.wait();
    EXPECT_GE(tick.since_ns, 0);
    periods += 1 + tick.skipped;
  }
  // On the grid: the time that passed is the periods counted, to within the last tick's lateness.
  EXPECT_GE(watch.ns(), static_cast<double>(periods * 500000 - 500000));
}

TEST(RealTimeScope, SaysForEachThingEitherThatItIsThereOrHowToAllowIt) {
  std::thread([] {
    const RealTimeScope scope{RealTimeRequest{}};
    const RealTimeReport& report = scope.report();
    const std::size_t there = (report.core >= 0 ? 1U : 0U) + (report.priority > 0 ? 1U : 0U) +
                              (report.memory_locked ? 1U : 0U) + (report.latency_held ? 1U : 0U);
    EXPECT_EQ(there + report.missing.size(), 4U);
    for (const std::string& line : report.missing) EXPECT_NE(line.find(": "), std::string::npos) << line;
  }).join();
}

TEST(RealTimeScope, CoreThatDoesNotExistIsReportedNotFatal) {
  std::thread([] {
    RealTimeRequest request;
    request.core = 1000;
    request.priority = 0;
    request.lock_memory = request.hold_latency = false;
    const RealTimeScope scope(request);
    ASSERT_EQ(scope.report().missing.size(), 1U);
    EXPECT_NE(scope.report().missing[0].find("core 1000"), std::string::npos);
  }).join();
}

TEST(DenormalScope, FlushesWithinAndNotAfter) {
  volatile float smallest = std::numeric_limits<float>::min();
  {
    const DenormalScope scope;
    const volatile float half = smallest * 0.5F;
#if defined(__x86_64__) || defined(__aarch64__)
    EXPECT_EQ(half, 0.0F);
#endif
  }
  const volatile float half = smallest * 0.5F;
  EXPECT_NE(half, 0.0F);
}

TEST(Adoption, ResultIsPutInExceptWhereTheFieldWasEditedSince) {
  const engine::Version base = fettle::tests::fieldOf(300, 200, [](int c, int r) { return c + r; });
  engine::LiveField job(base, engine::Growth::kAllowed);
  ASSERT_TRUE(job.setHeight(10, 10, -1.0F));
  ASSERT_TRUE(job.setHeight(100, 10, -2.0F));
  ASSERT_TRUE(job.setHeight(299, 199, -3.0F));
  engine::LiveField live(base, engine::Growth::kAllowed);
  ASSERT_TRUE(live.setHeight(70, 60, 5.0F));   // the second of the job's tiles
  ASSERT_TRUE(live.setHeight(10, 150, 6.0F));  // none of them

  const auto merged = mergeResult(live.snapshot(), base, job.snapshot());
  ASSERT_TRUE(merged);
  const engine::FieldReader reader = merged->version.reader();
  EXPECT_EQ(reader.heightAt(10, 10), -1.0F);
  EXPECT_EQ(reader.heightAt(100, 10), 110.0F);
  EXPECT_EQ(reader.heightAt(299, 199), -3.0F);
  EXPECT_EQ(reader.heightAt(70, 60), 5.0F);
  EXPECT_EQ(reader.heightAt(10, 150), 6.0F);
  ASSERT_EQ(merged->conflicts.size(), 1U);
  EXPECT_EQ(merged->conflicts[0], (TileSpot{1, 0}));
}

TEST(Adoption, HaloIsCutAtTheBorderAndHasNoDoubles) {
  engine::Grid grid;
  grid.width = 200;  // 4 x 3 tiles
  grid.height = 190;
  EXPECT_EQ(withHalo({{0, 0}, {1, 0}}, 1, grid),
            (std::vector<TileSpot>{{0, 0}, {1, 0}, {2, 0}, {0, 1}, {1, 1}, {2, 1}}));
  EXPECT_EQ(withHalo({{3, 2}}, 0, grid), (std::vector<TileSpot>{{3, 2}}));
  EXPECT_EQ(withHalo({{3, 2}}, 65, grid).size(), 9U);
}

}  // namespace
}  // namespace fettle::haptic
