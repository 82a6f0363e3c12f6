#include <chrono>
#include <limits>
#include <optional>
#include <random>
#include <thread>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "engine/field/difference.h"
#include "engine/filter/catalogue.h"
#include "engine/filter/pass.h"
#include "tests/engine/filter/reference.h"

namespace fettle::engine::tests {
namespace {

// Rich in what could make one cut of the work differ from another: holes in some blocks and not in others,
// heights in some blocks that need another kind of sum, marks.
PlainField variedField(int width, int height) {
  std::mt19937 random(99);
  PlainField p = formed(width, height, [&](int c, int r) {
    const float v = static_cast<float>(random() % 1000003U) * 1.7e-5F - 8.0F;
    if (c > width / 2 && r > height / 2 && random() % 7 == 0) return std::numeric_limits<float>::quiet_NaN();
    if (c < width / 4 && r < height / 3 && random() % 31 == 0) return v * 1e12F;
    if (c < width / 3 && r > height / 2) return v * 1e-18F * static_cast<float>(random() % 3);
    return v;
  });
  for (std::size_t i = 0; i < p.z.size(); ++i) p.marks.push_back(random() % 50 == 0 ? 1 : 0);
  return p;
}

TEST(Jobs, GiveTheSameBitsForAnyNumberOfThreadsAnyCutOfTheWorkAndAnyProcessor) {
  // The machine may have fewer cores than five; this lets the arena have its five threads all the same.
  const tbb::global_control five(tbb::global_control::max_allowed_parallelism, 5);
  const Version large = toVersion(variedField(450, 260)), small = toVersion(variedField(180, 130));
  for (const FilterKind kind : kEveryKind) {
    // Splines over holes like these take seconds in the large one.
    const Version& input = separatesScales(filterOf(kind)) ? small : large;
    for (const int window : windowsOf(kind, {3, 5, 7, 9, 11, 21, 131})) {
      // Its time goes with the window's samples.
      if ((kind == FilterKind::kBilateral || kind == FilterKind::kOutliers) && window > 21) continue;
      FilterSpec spec = makeSpec(kind, window);
      spec.passes = window == 3 ? 1 : 2;
      spec.max_change = 4.0;
      std::optional<PlainField> first;
      std::optional<FilterReport> first_report;
      struct Way {
        int threads;
        FilterTuning tuning;
      };
      for (const auto& [threads, tuning] : {Way{1, {}},
                                            {2, {64}},
                                            {5, {128}},
                                            {5, {64}},
                                            {1, {1024}},
                                            {2, {0, CpuLevel::kAvx2}},
                                            {2, {128, CpuLevel::kPlain}}}) {
        spec.threads = threads;
        JobControl job;
        const Result<Filtered> result = applyFilter(input, input, spec, tuning, job);
        ASSERT_TRUE(result);
        const PlainField plain = toPlain(result->field);
        if (!first) {
          first = plain;
          first_report = result->report;
          continue;
        }
        EXPECT_TRUE(sameBits(*first, plain)) << name(kind) << window << " " << threads << " "
                                             << tuning.block_side << " " << static_cast<int>(tuning.level);
        EXPECT_EQ(first_report->changed, result->report.changed);
        EXPECT_EQ(first_report->rms_change, result->report.rms_change);
        EXPECT_EQ(first_report->max_change, result->report.max_change);
      }
      // Of a large window no sample stands apart.
      const double share = kind == FilterKind::kPlanes ? 0.08 : kind == FilterKind::kOutliers ? 0.007 : 0.59;
      if (kind != FilterKind::kOutliers || window <= 5) {
        EXPECT_GT(first_report->changed, static_cast<double>(input.grid().samples()) * share) << name(kind);
      }
    }
  }
}

TEST(Jobs, CountTheirProgressToTheEnd) {
  const Version input = toVersion(variedField(300, 200));
  FilterSpec spec = makeSpec(FilterKind::kBox, 3);
  spec.passes = 3;
  JobControl job;
  ASSERT_TRUE(applyFilter(input, input, spec, job));
  EXPECT_STREQ(job.stage(), "filtering");
  EXPECT_EQ(job.total(), 3U * 300U * 200U);
  EXPECT_EQ(job.done(), job.total());
}

TEST(Jobs, CancelledBeforeTheyStartDoNothing) {
  const Version input = toVersion(variedField(300, 200));
  JobControl job;
  job.cancel();
  const Result<Filtered> result = applyFilter(input, input, makeSpec(FilterKind::kMedian, 31), job);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().kind, ErrorKind::kCancelled);
}

TEST(Jobs, StopSoonWhenCancelledWithTheLargestWindowAndLeaveTheInputAsItWas) {
  const Version input = toVersion(variedField(1500, 1300));
  const std::uint64_t hash = contentHash(input);
  const std::size_t tiles = input.memory()->tiles.liveObjects();
  for (const FilterKind kind : kEveryKind) {
    FilterSpec spec = makeSpec(kind, 1001, kind == FilterKind::kGaussian ? 300.0 : 0.0);
    spec.passes = 1000;
    JobControl job;
    std::optional<Result<Filtered>> result;
    std::thread worker([&] { result.emplace(applyFilter(input, input, spec, job)); });
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    const auto start = std::chrono::steady_clock::now();
    job.cancel();
    worker.join();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    ASSERT_FALSE(*result) << name(kind);
    EXPECT_EQ(result->error().kind, ErrorKind::kCancelled);
    // 0.2 s promised on an idle machine; tests run on busy ones, under sanitizers too.
    EXPECT_LT(took.count(), 1.0) << name(kind);
    RecordProperty(std::string(name(kind)), std::to_string(took.count()));
    result.reset();
    EXPECT_EQ(input.memory()->tiles.liveObjects(), tiles) << "what was made is freed again";
  }
  EXPECT_EQ(contentHash(input), hash);
}

TEST(Jobs, HoldNoMoreTilesThanTheInputAndTwoResults) {
  const Version input = toVersion(variedField(640, 640));
  FilterSpec spec = makeSpec(FilterKind::kBox, 3);
  spec.passes = 20;
  const std::size_t tiles = input.memory()->tiles.liveObjects();
  JobControl job;
  const Result<Filtered> result = applyFilter(input, input, spec, job);
  ASSERT_TRUE(result);
  // Freed tiles stay in the pool, so the pool shows the most that was ever held at once.
  const std::size_t most = input.memory()->tiles.liveObjects() + input.memory()->tiles.freeObjects();
  EXPECT_LE(most, 3 * tiles + 256U) << "one slab of tiles more at the most";
  EXPECT_LE(input.memory()->tiles.liveObjects(), 2 * tiles);
}

}  // namespace
}  // namespace fettle::engine::tests
