#include "engine/remove/remove.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/history/history.h"
#include "tests/support/no_data.h"

namespace fettle::engine {
namespace {

using Heights = RemoveOptions::Heights;

constexpr int kWide = 150, kHigh = 100;

// Heights from -1 to 1, a tenth of them holes, a fifth marked, holes too.
Version roughField(int width = kWide, int height = kHigh) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  std::vector<float> z(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  std::vector<std::uint8_t> marks(z.size());
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
  for (std::size_t i = 0; i < z.size(); ++i) {
    z[i] = uniform(random) < -0.8F ? kNan : uniform(random);
    marks[i] = uniform(random) < -0.6F ? 1 : 0;
  }
  return makeField(grid, z, marks);
}

bool isMeant(float z, bool marked, const RemoveOptions& options) {
  const bool between = options.heights == Heights::kBetween;
  const bool high = between ? z >= options.low && z <= options.high : z < options.low || z > options.high;
  return high && (options.region == Region::kAll || marked == (options.region == Region::kMarked));
}

// Against the plain definition, sample by sample.
void expectRemoved(const Version& before, const RemoveOptions& options) {
  JobControl job;
  const auto done = removeSamples(before, options, job);
  ASSERT_TRUE(done) << done.error().line();
  const auto counted = countRemoved(before, options, job);
  ASSERT_TRUE(counted);
  EXPECT_EQ(counted->removed, done->counts.removed);
  EXPECT_EQ(counted->spared, done->counts.spared);
  const FieldReader was = before.reader(), is = done->field.reader();
  RemoveCounts expected;
  std::int64_t marked_still = 0;
  for (int r = 0; r < was.height(); ++r)
    for (int c = 0; c < was.width(); ++c) {
      const float z = was.heightAt(c, r);
      const bool marked = was.markedAt(c, r), gone = isMeant(z, marked, options);
      expected.heights += std::isnan(z) ? 0 : 1;
      expected.removed += gone ? 1 : 0;
      RemoveOptions other = options;
      other.region = Region::kMarked;
      expected.spared += options.region == Region::kUnmarked && isMeant(z, marked, other) ? 1 : 0;
      ASSERT_EQ(std::isnan(is.heightAt(c, r)), gone || std::isnan(z)) << c << " " << r;
      if (!std::isnan(z) && !gone) {
        ASSERT_EQ(is.heightAt(c, r), z);
      }
      marked_still += marked && !gone ? 1 : 0;
      ASSERT_EQ(is.markedAt(c, r), marked && !gone) << "a hole that was removed keeps no mark, all else does";
    }
  EXPECT_EQ(done->counts.heights, expected.heights);
  EXPECT_EQ(done->counts.removed, expected.removed);
  EXPECT_EQ(done->counts.spared, expected.spared);
  // Bounds and counts are those of a field that was built so.
  const FieldSummary summary = summarize(done->field);
  EXPECT_EQ(summary.no_data, summarize(before).no_data + expected.removed);
  EXPECT_EQ(summary.marked, marked_still);
  EXPECT_EQ(is.bounds(), (HeightBounds{static_cast<float>(summary.min), static_cast<float>(summary.max)}));
}

TEST(Remove, SamplesBelowAboveBetweenAndOutsideBecomeHoles) {
  const Version field = roughField();
  constexpr double kNoLimit = std::numeric_limits<double>::infinity();
  for (const Region region : {Region::kUnmarked, Region::kMarked, Region::kAll}) {
    expectRemoved(field, {Heights::kOutside, -0.5, kNoLimit, region});
    expectRemoved(field, {Heights::kOutside, -kNoLimit, 0.25, region});
    expectRemoved(field, {Heights::kBetween, -0.5, 0.25, region});
    expectRemoved(field, {Heights::kOutside, -0.5, 0.25, region});
    expectRemoved(field.inverted(), {Heights::kOutside, -0.75, 0.1, region});
    expectRemoved(field.inverted(), {Heights::kBetween, -0.75, 0.1, region});
  }
  expectRemoved(roughField(700, 1), {Heights::kBetween, 0.0, 0.5});
  expectRemoved(roughField(1, 700), {Heights::kOutside, 0.0, 0.5});
}

TEST(Remove, WhatIsMarkedGoesWhenItIsNamedAndOnlyThen) {
  const Version field = roughField();
  expectRemoved(field, {.region = Region::kMarked});
  expectRemoved(field, {.region = Region::kUnmarked});
  JobControl job;
  const auto marked = removeSamples(field, {.region = Region::kMarked}, job);
  ASSERT_TRUE(marked);
  EXPECT_GT(marked->counts.removed, 1000);
  EXPECT_EQ(marked->counts.spared, 0);
  const auto low = removeSamples(field, {.heights = Heights::kOutside, .low = 0.0}, job);
  ASSERT_TRUE(low);
  EXPECT_GT(low->counts.spared, 500);
  for (int c = 0; c < kWide; ++c)
    EXPECT_EQ(low->field.reader().markedAt(c, 0), field.reader().markedAt(c, 0));
}

TEST(Remove, LimitsThatAreHeightsOfSamplesBelongToBetweenAndNotToOutside) {
  Grid grid;
  grid.width = 3;
  grid.height = 1;
  const Version field = makeField(grid, {1.0F, 2.0F, 3.0F});
  JobControl job;
  EXPECT_EQ(countRemoved(field, {Heights::kBetween, 2.0, 3.0}, job)->removed, 2);
  EXPECT_EQ(countRemoved(field, {Heights::kOutside, 2.0, 3.0}, job)->removed, 1);
  EXPECT_EQ(countRemoved(field, {Heights::kBetween, 2.0, 2.0}, job)->removed, 1);
  // In double: no sample is 0.1.
  const Version tenth = makeField(grid, {0.1F, 0.0F, 0.0F});
  EXPECT_EQ(countRemoved(tenth, {Heights::kBetween, 0.1, 0.1}, job)->removed, 0);
  EXPECT_EQ(countRemoved(tenth, {Heights::kBetween, -0.0, 0.0}, job)->removed, 2);
}

TEST(Remove, NothingChosenSharesEverythingAndAllChosenIsRefused) {
  const Version field = roughField();
  JobControl job;
  const auto none = removeSamples(field, {Heights::kOutside, -2.0, 2.0}, job);
  ASSERT_TRUE(none);
  EXPECT_EQ(none->counts.removed, 0);
  EXPECT_TRUE(none->field == field);
  for (const RemoveOptions& all :
       {RemoveOptions{.region = Region::kAll}, RemoveOptions{Heights::kBetween, -1.0, 1.0, Region::kAll},
        RemoveOptions{.heights = Heights::kOutside, .low = 5.0, .region = Region::kAll}}) {
    const auto refused = removeSamples(field, all, job);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::kInput);
    EXPECT_EQ(refused.error().what, "every sample would be removed");
    const auto counted = countRemoved(field, all, job);
    ASSERT_TRUE(counted);
    EXPECT_EQ(counted->removed, counted->heights);
  }
  // A field of holes alone has nothing that would go.
  Grid grid;
  grid.width = 70;
  grid.height = 2;
  const Version holes = makeField(grid, std::vector<float>(140, kNan));
  const auto still = removeSamples(holes, {.region = Region::kAll}, job);
  ASSERT_TRUE(still);
  EXPECT_EQ(still->counts.heights, 0);
  EXPECT_EQ(contentHash(still->field), contentHash(holes));
}

TEST(Remove, LimitsThatAreNoIntervalAreRefused) {
  const Version field = roughField();
  JobControl job;
  for (const auto& [low, high] : {std::pair(std::nan(""), 1.0), {0.0, std::nan("")}, {1.0, 0.5}})
    for (const Heights heights : {Heights::kBetween, Heights::kOutside}) {
      const RemoveOptions options{heights, low, high, Region::kAll};
      ASSERT_FALSE(removeSamples(field, options, job));
      EXPECT_EQ(countRemoved(field, options, job).error().kind, ErrorKind::kInput);
    }
}

// One sample of a large plain: one tile is another.
TEST(Remove, TilesWithoutARemovedSampleStayShared) {
  Grid grid;
  grid.width = grid.height = 640;
  std::vector<float> z(640 * 640, 1.0F);
  z[100 * 640 + 200] = -3.0F;
  const Version field = makeField(grid, z);
  JobControl job;
  const auto done = removeSamples(field, {.heights = Heights::kOutside, .low = 0.0}, job);
  ASSERT_TRUE(done);
  EXPECT_EQ(done->counts.removed, 1);
  EXPECT_EQ(measureChange(field, done->field).tiles, 1);
  EXPECT_TRUE(std::isnan(done->field.reader().heightAt(200, 100)));
}

TEST(Remove, EndsWhenItIsCancelledAndSaysHowFarItIs) {
  const Version field = roughField();
  JobControl job;
  ASSERT_TRUE(removeSamples(field, {Heights::kOutside, -0.5, 0.5}, job));
  EXPECT_EQ(job.total(), 2U);
  EXPECT_EQ(job.done(), 2U);
  job.cancel();
  const auto ended = removeSamples(field, {Heights::kOutside, -0.5, 0.5}, job);
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::engine
