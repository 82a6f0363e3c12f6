#include "engine/fill/filled_samples.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/fill/fill.h"

namespace fettle::engine {
namespace {

TEST(FilledSamples, AreThoseWithAHeightWhereTheScanHadNone) {
  Grid grid;
  grid.width = 150;
  grid.height = 100;
  std::vector<float> z(15000);
  std::vector<std::uint8_t> marks(z.size());
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform;
  for (std::size_t i = 0; i < z.size(); ++i) {
    z[i] = uniform(random) < 0.1F ? std::numeric_limits<float>::quiet_NaN() : uniform(random);
    marks[i] = uniform(random) < 0.02F ? 1 : 0;
  }
  const Version scan = makeField(grid, z, marks).inverted();
  JobControl job;
  const auto filled = fillHoles(scan, {}, job);
  ASSERT_TRUE(filled);
  ASSERT_GT(filled->filled, 1000);
  EXPECT_EQ(countFilled(filled->field, scan), filled->filled);
  EXPECT_EQ(countFilled(scan, scan), 0);

  const auto measured = withoutFilled(filled->field, scan, job);
  ASSERT_TRUE(measured);
  EXPECT_EQ(contentHash(*measured), contentHash(scan));
  EXPECT_EQ(summarize(*measured).no_data, summarize(scan).no_data);
  EXPECT_EQ(measured->reader().bounds(), scan.reader().bounds());

  const auto marked = withFilledMarked(filled->field, scan, OtherMarks::kStay, job);
  ASSERT_TRUE(marked);
  std::int64_t more = 0;
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) {
      const bool is =
          std::isnan(scan.reader().heightAt(c, r)) && !std::isnan(marked->reader().heightAt(c, r));
      more += is ? 1 : 0;
      EXPECT_EQ(marked->reader().markedAt(c, r), is || scan.reader().markedAt(c, r));
    }
  EXPECT_EQ(more, filled->filled);
  EXPECT_EQ(summarize(*marked).marked, summarize(scan).marked + more);
  const auto alone = withFilledMarked(filled->field, scan, OtherMarks::kGo, job);
  ASSERT_TRUE(alone);
  EXPECT_EQ(summarize(*alone).marked, more);
}

// 1 to 8, the middle ones removed and filled again, one of them filled only in part: the scan has no height there any more.
TEST(FilledSamples, RemovedAndFilledAgainAreNotMeasured) {
  Grid grid;
  grid.width = 70;
  grid.height = 3;
  const std::vector<std::uint8_t> none(210);
  std::vector<float> z(210, 1.0F);
  z[5] = std::numeric_limits<float>::quiet_NaN();
  const Version scan = makeField(grid, z, none);
  std::vector<float> without = z;
  for (const std::size_t i : {20U, 21U, 90U}) without[i] = z[5];
  const Version removed = makeField(grid, without, none);
  std::vector<float> with = without;
  for (const std::size_t i : {5U, 20U, 90U}) with[i] = 2.0F;
  const Version filled = makeField(grid, with, none);
  JobControl job;
  EXPECT_EQ(countFilled(filled, scan), 1);
  const auto measured = withoutReplaced(scan, removed, filled, job);
  ASSERT_TRUE(measured);
  EXPECT_EQ(countFilled(filled, *measured), 3);
  EXPECT_EQ(summarize(*measured).no_data, 3);
  EXPECT_EQ(measured->reader().heightAt(21, 0), 1.0F) << "removed and still a hole: nothing took its place";
  EXPECT_EQ(&measured->reader().tile(1, 0), &scan.reader().tile(1, 0)) << "shared";
  const auto same = withoutReplaced(scan, scan, filled, job);
  ASSERT_TRUE(same);
  EXPECT_TRUE(*same == scan);
}

}  // namespace
}  // namespace fettle::engine
