#include "engine/compare/live_deviation.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "engine/compare/compare.h"
#include "engine/field/builder.h"
#include "engine/field/live_field.h"
#include "engine/filter/filter.h"

namespace fettle::engine {
namespace {

Version field(int width, int height, double level, bool holes = true) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  std::mt19937 random(11);
  std::vector<float> z;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) {
      const double noise = static_cast<double>(random()) / 4294967296.0 - 0.5;
      const bool hole = holes && random() % 50 == 0;
      z.push_back(hole ? std::numeric_limits<float>::quiet_NaN()
                       : static_cast<float>(level + 0.1 * c - 0.05 * r + noise));
    }
  return makeField(grid, z);
}

LiveDeviation live(const Version& original) {
  JobControl job;
  return *LiveDeviation::create(original, job);
}

// All figures against compareFields. Sums of n doubles of one size err by at most n 2^-53 of their sum of
// sizes; n is below 2^18 here, and Sq and rms are roots of such sums.
void agrees(const LiveFigures& figures, const Version& original, const Version& now) {
  JobControl job;
  const Deviation whole = *compareFields(original, now, job);
  EXPECT_EQ(figures.samples, whole.samples);
  EXPECT_EQ(figures.max_abs, whole.max_abs);
  EXPECT_NEAR(figures.rms, whole.rms, 1e-9 * whole.rms);
  EXPECT_NEAR(figures.sq_original, whole.sq_a, 1e-9 * whole.sq_a);
  EXPECT_NEAR(figures.sq, whole.sq_b, 1e-9 * whole.sq_b);
  EXPECT_NEAR(figures.sa_original, whole.sa_a, 1e-9 * whole.sa_a);
  EXPECT_NEAR(figures.sa, whole.sa_b, figures.sa_plane_shift + 1e-9 * whole.sa_b);
  std::int64_t counted = figures.histogram.unchanged;
  for (const std::int64_t n : figures.histogram.counts) counted += n;
  EXPECT_EQ(counted, whole.samples);
}

Version edited(const Version& from, std::uint32_t seed, int edits) {
  LiveField field(from, Growth::kAllowed);
  std::mt19937 random(seed);
  for (int i = 0; i < edits; ++i) {
    const auto c = static_cast<std::int32_t>(random() % static_cast<std::uint32_t>(from.grid().width));
    const auto r = static_cast<std::int32_t>(random() % static_cast<std::uint32_t>(from.grid().height));
    const float z = from.reader().heightAt(c, r);
    const float by = static_cast<float>(random() % 1000) * 1e-3F;
    const float now = random() % 20 == 0 ? std::numeric_limits<float>::quiet_NaN() : z + by;
    EXPECT_TRUE(field.setHeight(c, r, now));
  }
  return field.snapshot();
}

TEST(LiveDeviation, follows_edits_undo_and_filters_as_a_whole_comparison_does) {
  for (const double level : {0.0, 1e5}) {
    const Version original = field(300, 217, level);
    LiveDeviation deviation = live(original);
    JobControl job;
    agrees(*deviation.update(original, job), original, original);
    const Version once = edited(original, 1, 40), twice = edited(once, 2, 500);
    FilterSpec median;
    median.kind = FilterKind::kMedian;
    median.window = 5;
    const Version filtered = applyFilter(twice, original, median, job)->field;
    for (const Version* v : {&once, &twice, &filtered, &twice, &original, &filtered, &once})
      agrees(*deviation.update(*v, job), original, *v);
  }
}

TEST(LiveDeviation, gives_the_same_bits_whatever_the_way_and_the_threads) {
  const Version original = field(300, 217, 10.0), once = edited(original, 1, 300),
                twice = edited(once, 2, 300);
  JobControl job;
  LiveDeviation by_steps = live(original), at_once = live(original);
  (void)by_steps.update(once, job);
  const LiveFigures a = *by_steps.update(twice, job);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const LiveFigures b = *at_once.update(twice, job);
  EXPECT_EQ(a.sq, b.sq);
  EXPECT_EQ(a.sa, b.sa);
  EXPECT_EQ(a.rms, b.rms);
  EXPECT_EQ(a.histogram.counts, b.histogram.counts);
}

TEST(LiveDeviation, each_change_is_counted_in_the_class_that_holds_it) {
  Grid grid;
  grid.width = grid.height = 70;
  const Version original = makeField(grid, std::vector<float>(4900, 0.0F));
  LiveField field(original, Growth::kAllowed);
  const std::vector<float> changes{0.75F, -0.75F, 0.01F, -0.01F, 1.0F - 1.0F / 32.0F};
  for (std::size_t i = 0; i < changes.size(); ++i)
    ASSERT_TRUE(field.setHeight(static_cast<std::int32_t>(i), 66, changes[i]));
  JobControl job;
  LiveDeviation deviation = live(original);
  const ChangeHistogram h = deviation.update(field.snapshot(), job)->histogram;
  EXPECT_EQ(h.reach, 1.0);
  EXPECT_EQ(h.unchanged, 4900 - 5);
  for (const float d : changes)
    for (int i = 0; i < ChangeHistogram::kClasses; ++i)
      if (h.lowEnd(i) <= static_cast<double>(d) && static_cast<double>(d) < h.lowEnd(i + 1)) {
        EXPECT_EQ(h.counts[static_cast<std::size_t>(i)], 1) << d;
      }
  EXPECT_EQ(deviation.update(original, job)->histogram.reach, 0.0);
}

TEST(LiveDeviation, planes_one_row_one_sample_and_holes_alone_have_figures) {
  JobControl job;
  for (const auto& [w, h] : {std::pair{1, 1}, {500, 1}, {1, 300}}) {
    const Version v = field(w, h, 3.0, false);
    LiveDeviation deviation = live(v);
    const LiveFigures f = *deviation.update(v, job);
    EXPECT_EQ(f.samples, w * h);
    EXPECT_TRUE(std::isfinite(f.sq) && std::isfinite(f.sa));
  }
  Grid grid;
  grid.width = grid.height = 65;
  const Version none = makeField(grid, std::vector<float>(65 * 65, std::numeric_limits<float>::quiet_NaN()));
  LiveDeviation deviation = live(none);
  EXPECT_EQ(deviation.update(none, job)->samples, 0);
}

TEST(LiveDeviation, a_cancel_changes_nothing) {
  const Version original = field(200, 200, 0.0), now = edited(original, 1, 100);
  LiveDeviation deviation = live(original);
  JobControl stopped;
  stopped.cancel();
  EXPECT_EQ(deviation.update(now, stopped).error().kind, ErrorKind::kCancelled);
  EXPECT_EQ(LiveDeviation::create(original, stopped).error().kind, ErrorKind::kCancelled);
  JobControl job;
  agrees(*deviation.update(now, job), original, now);
}

}  // namespace
}  // namespace fettle::engine
