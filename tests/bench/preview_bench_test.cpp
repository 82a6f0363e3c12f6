// Previews: what is timed is there, in its order.
#include "bench/preview_bench.h"

#include <gtest/gtest.h>

namespace fettle::bench {
namespace {

TEST(PreviewBench, EachFilterIsSeenWholeAndInPart) {
  PreviewBenchOptions options;
  options.sides = {256, 1500};
  options.kinds = {engine::FilterKind::kMedian, engine::FilterKind::kGeneralisedVariation};
  engine::JobControl job;
  const auto report = benchPreviews(options, job);
  ASSERT_TRUE(report) << report.error().line();
  ASSERT_EQ(report->rows.size(), 8U);
  // Three kinds of holes, two ways to level lines.
  ASSERT_EQ(report->heights.size(), 2U * 2U * 5U);
  EXPECT_EQ(report->heights[2].what, "fill discs");
  EXPECT_EQ(report->heights[8].what, "level matching");
  for (const HeightPreviewRow& row : report->heights) {
    EXPECT_GE(row.whole, row.first) << row.what;
    EXPECT_GT(row.alone, 0.0);
    const bool fills = row.what.starts_with("fill");
    // Lines of so small a field are levelled at once; of holes the large one of the smaller field reaches its border, that of the
    // larger one begins with means.
    const bool large = row.what == "fill one large";
    EXPECT_EQ(row.first > 0.0, fills && !(large && row.side == 256)) << row.what;
    if (large && row.first > 0.0) {
      EXPECT_GT(row.off_whole, 0.0);
      EXPECT_LT(row.off_whole, 2.0 * row.off_said);
    } else {
      EXPECT_EQ(row.off_whole, 0.0) << "exact";
      EXPECT_EQ(row.exact > 0.0, row.first > 0.0) << row.what << row.side;
    }
  }
  EXPECT_EQ(report->rows[0].filter, "median 5");
  EXPECT_EQ(report->rows[2].filter, "tgv");
  for (std::size_t i = 0; i < report->rows.size(); ++i) {
    const PreviewBenchRow& row = report->rows[i];
    EXPECT_EQ(row.side, i < 4 ? 256 : 1500);
    EXPECT_GT(row.first, 0.0);
    EXPECT_GE(row.exact, row.first);
    if (i % 2 == 0 || row.side == 256) {
      EXPECT_GE(row.whole, row.exact);
    } else {
      EXPECT_EQ(row.whole, 0.0);
    }
  }
  EXPECT_EQ(report->rows[4].seen, 24 * 24 * 4096);
  EXPECT_LT(report->rows[5].seen, report->rows[4].seen);
}

TEST(PreviewBench, OptionsOutOfRangeAreRefusedAndACancelIsHeard) {
  engine::JobControl job;
  PreviewBenchOptions options;
  options.sides = {100};
  EXPECT_EQ(benchPreviews(options, job).error().kind, engine::ErrorKind::kInput);
  options.sides = {256};
  options.limit_s = 0.0;
  EXPECT_EQ(benchPreviews(options, job).error().kind, engine::ErrorKind::kInput);
  options.limit_s = 10.0;
  options.window = 4;
  EXPECT_EQ(benchPreviews(options, job).error().kind, engine::ErrorKind::kInput);
  options.window = 5;
  job.cancel();
  EXPECT_EQ(benchPreviews(options, job).error().kind, engine::ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::bench
