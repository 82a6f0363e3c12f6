#include "engine/inspect/histogram.h"

#include <cfloat>
#include <cmath>
#include <numeric>
#include <string>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "tests/engine/inspect/grids.h"

namespace fettle::engine {
namespace {

using Counts = std::vector<std::int64_t>;

HeightHistogram histogram(const Version& field, int bins) {
  JobControl job;
  const auto counted = countHeights(field, bins, job);
  EXPECT_TRUE(counted);
  return counted.value_or(HeightHistogram{});
}

TEST(Histogram, BinsHoldTheirLowEndAndTheLastItsHighEnd) {
  const HeightHistogram h = histogram(makeField(gridOf(8, 1), {0, 1, 2, 3, 4, NAN, 1.5F, -0.0F}), 4);
  EXPECT_EQ(h.low, 0.0);
  EXPECT_EQ(h.high, 4.0);
  EXPECT_EQ(h.counts, (Counts{2, 2, 1, 2}));
  EXPECT_EQ(h.lowEnd(3), 3.0);
}

TEST(Histogram, ItsProgressIsThatOfTheTiles) {
  JobControl job;
  ASSERT_TRUE(countHeights(makeField(gridOf(200, 70), std::vector<float>(200 * 70, 1.0F)), 4, job));
  EXPECT_EQ(job.stage(), std::string("counting heights"));
  EXPECT_EQ(job.total(), 4U * 2U);
  EXPECT_EQ(job.done(), job.total());
}

TEST(Histogram, CountsEverySampleOnceAndSeesTheSign) {
  std::vector<float> z;
  for (int i = 0; i < 200 * 300; ++i) z.push_back(static_cast<float>(i % 1000));
  const Version field = makeField(gridOf(200, 300), z);
  const HeightHistogram h = histogram(field, 10);
  // 0 .. 999 in ten bins of 99.9: 100 values each.
  EXPECT_EQ(h.counts, Counts(10, 6000));
  EXPECT_EQ(histogram(field.inverted(), 10).low, -999.0);
}

TEST(Histogram, OfEqualHeightsAndOfTheWholeRangeOfFloats) {
  EXPECT_EQ(histogram(makeField(gridOf(3, 1), {7, 7, 7}), 3).counts, (Counts{3, 0, 0}));
  EXPECT_EQ(histogram(makeField(gridOf(3, 1), {-FLT_MAX, 0, FLT_MAX}), 3).counts, (Counts{1, 1, 1}));
  const HeightHistogram none = histogram(makeField(gridOf(1, 1), {NAN}), 2);
  EXPECT_TRUE(std::isnan(none.low));
  EXPECT_EQ(none.counts, (Counts{0, 0}));
}

TEST(Histogram, RefusesBinsThatCannotBe) {
  JobControl job;
  for (const int bins : {0, -1, kMostBins + 1})
    EXPECT_FALSE(countHeights(makeField(gridOf(1, 1), {1}), bins, job)) << bins;
}

}  // namespace
}  // namespace fettle::engine
