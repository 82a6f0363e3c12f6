// What the filter benchmark prints is about the filter, the window and the ground that the row names.
#include "bench/filters_bench.h"

#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "engine/filter/catalogue.h"
#include "tests/engine/filter/cpu_tgv_device.h"

namespace fettle::bench {
namespace {

using engine::FilterKind;

TEST(FiltersBench, HasARowForEachKindWindowGroundAndNumberOfThreadsAndAHashThatThreadsDoNotChange) {
  FiltersBenchOptions options;
  options.side = 200;
  options.windows = {3, 11};
  options.repeats = 2;
  engine::JobControl job;
  const auto report = benchFilters(options, job);
  ASSERT_TRUE(report) << report.error().line();
  ASSERT_EQ(report->rows.size(), options.kinds.size() * 2U * 3U * 2U);
  std::set<std::uint64_t> hashes;
  std::set<std::tuple<FilterKind, int, FilterGround, int>> rows;
  for (const FiltersBenchRow& row : report->rows) {
    rows.insert({row.kind, row.window, row.ground, row.threads});
    hashes.insert(row.hash);
    EXPECT_EQ(row.side, 200);
    EXPECT_GT(row.slowest, 0.0);
    EXPECT_LE(row.slowest, row.median);
    EXPECT_LE(row.median, row.fastest);
    EXPECT_GT(row.cpu, 0.0);
    EXPECT_GT(row.copy, 0.0);
    EXPECT_GT(row.copy_cpu, 0.0);
    if (row.threads == 1)
      EXPECT_EQ(row.over_one, 1.0);
    else
      EXPECT_GT(row.over_one, 0.0);
  }
  EXPECT_EQ(rows.size(), report->rows.size());
  EXPECT_EQ(hashes.size(), report->rows.size() / 2);
}

TEST(FiltersBench, NamesTheTargetsOfThePapersFiltersOnPlainGround) {
  FiltersBenchRow row;
  for (const FilterKind kind : {FilterKind::kBox, FilterKind::kGaussian, FilterKind::kMedian})
    for (const int window : FiltersBenchOptions{}.windows) {
      row.kind = kind;
      row.window = window;
      row.threads = 1;
      // A Gaussian of 31 lies between two that have one.
      EXPECT_EQ(targetOf(row).share > 0.0, !(kind == FilterKind::kGaussian && window == 31));
      EXPECT_EQ(targetOf(row).over_one, 0.0);
      row.threads = 2;
      EXPECT_EQ(targetOf(row).over_one, 1.8);
      EXPECT_EQ(targetOf(row).share, 0.0);
    }
  row.ground = FilterGround::kHoles;
  EXPECT_EQ(targetOf(row).over_one, 0.0);
}

// Every setting that suggestFilter tries has its cost beside what it takes here; others, and several threads, have none.
TEST(FiltersBench, NamesTheCostsThatSuggestionsGoBy) {
  int costs = 0;
  for (const engine::Filter& filter : engine::filters())
    for (const engine::FilterTrial& trial : filter.trials) {
      FiltersBenchRow row;
      row.kind = filter.kind;
      row.window = trial.window;
      row.threads = 1;
      EXPECT_EQ(suggestedCost(row), trial.cost) << filter.word << " " << trial.window;
      row.threads = 2;
      EXPECT_EQ(suggestedCost(row), 0.0);
      ++costs;
    }
  EXPECT_GT(costs, 20);
  FiltersBenchRow other;
  other.kind = FilterKind::kBox;
  other.window = 101;
  other.threads = 1;
  EXPECT_EQ(suggestedCost(other), 0.0);
}

TEST(FiltersBench, MeasuresASmallerFieldWhereTheLimitLeavesNoTimeForTheWhole) {
  FiltersBenchOptions options;
  options.side = 2048;
  options.kinds = {FilterKind::kBox};
  options.windows = {3};
  options.grounds = {FilterGround::kHoles};
  options.threads = {1};
  options.repeats = 1;
  options.limit_s = 1e-9;
  engine::JobControl job;
  const auto report = benchFilters(options, job);
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_EQ(report->rows.front().side, 512);
}

TEST(FiltersBench, HasARowWithADeviceBesideEachOfTheProcessorForWhatCanUseIt) {
  engine::tests::CpuTgvDevice device;
  FiltersBenchOptions options;
  options.side = 128;
  options.kinds = {FilterKind::kBox, FilterKind::kGeneralisedVariation};
  options.windows = {3, 5};
  options.grounds = {FilterGround::kHoles};
  options.threads = {1};
  options.repeats = 1;
  options.device = &device;
  engine::JobControl job;
  const auto report = benchFilters(options, job);
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_EQ(report->device, device.name());
  // A filter without a window has one row for both.
  ASSERT_EQ(report->rows.size(), 4U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_FALSE(report->rows[i].on_device);
  const FiltersBenchRow &here = report->rows[2], &there = report->rows[3];
  EXPECT_TRUE(there.on_device);
  EXPECT_EQ(there.kind, FilterKind::kGeneralisedVariation);
  EXPECT_EQ(there.side, here.side);
  EXPECT_EQ(there.hash, here.hash);
  EXPECT_EQ(there.most_off, 0.0);
  EXPECT_GT(there.over_processor, 0.0);
  EXPECT_EQ(here.over_processor, 0.0);
  EXPECT_GE(device.squares, 3U);
}

// Strips of medians of 7 to 11 are not counted: nothing is claimed for them.
TEST(FiltersBench, SaysWhereNoBoundIsKnown) {
  FiltersBenchOptions options;
  options.side = 128;
  options.windows = {5, 11, 31};
  options.grounds = {FilterGround::kPlain};
  options.threads = {1};
  options.repeats = 1;
  options.bounds = true;
  engine::JobControl job;
  const auto report = benchFilters(options, job);
  ASSERT_TRUE(report) << report.error().line();
  ASSERT_EQ(report->rows.size(), 9U);
  for (const FiltersBenchRow& row : report->rows) {
    SCOPED_TRACE(std::string(engine::name(row.kind)) + " " + std::to_string(row.window));
    const bool known = row.kind != FilterKind::kMedian || row.window != 11;
    EXPECT_EQ(row.bound.whole, known);
    EXPECT_EQ(row.bound.operations > 0.0, known && row.kind != FilterKind::kBox);
    EXPECT_GT(row.bound.tiles, 0.0);
  }
}

// A Gaussian's window has as many weights in each direction, but those too small to matter. A median of 31 shares its sets with
// fifteen others: 46 columns are in some of them, of which 15 on each side are in 32 sets together.
TEST(FiltersBench, CountsWhatAGaussianAndALargeMedianCannotDoWithout) {
  FiltersBenchOptions options;
  options.side = 128;
  options.kinds = {FilterKind::kGaussian, FilterKind::kMedian};
  options.windows = {5, 31};
  options.grounds = {FilterGround::kPlain};
  options.threads = {1};
  options.repeats = 1;
  options.bounds = true;
  engine::JobControl job;
  const auto report = benchFilters(options, job);
  ASSERT_TRUE(report) << report.error().line();
  ASSERT_EQ(report->rows.size(), 4U);
  EXPECT_EQ(report->rows[0].bound.counted.products, 10.0);
  EXPECT_EQ(report->rows[1].bound.counted.products, 62.0);
  const Operations& median = report->rows[3].bound.counted;
  EXPECT_EQ(median.moves, 2.0 * 46.0 / 16.0);
  EXPECT_EQ(median.moves + median.flips, 2.0 * (16.0 + 2.0 * 32.0) / 16.0);
  EXPECT_EQ(median.selections, 1.0);
  EXPECT_EQ(median.sorts, 1.0);
  EXPECT_EQ(median.extrema, 0.0);
}

TEST(FiltersBench, HasTheBoundsOfADiskAndABallBesideTheirRowsOfOneThread) {
  FiltersBenchOptions options;
  options.side = 128;
  options.kinds = {FilterKind::kOpening};
  options.windows = {11};
  options.grounds = {FilterGround::kPlain};
  options.threads = {1, 2};
  options.repeats = 1;
  options.bounds = true;
  engine::JobControl job;
  const auto report = benchFilters(options, job);
  ASSERT_TRUE(report) << report.error().line();
  ASSERT_EQ(report->rows.size(), 6U);
  for (const FiltersBenchRow& row : report->rows) {
    SCOPED_TRACE(static_cast<int>(row.element));
    if (row.threads != 1) {
      EXPECT_EQ(row.bound.filter, 0.0);
      continue;
    }
    EXPECT_GT(row.bound.filter, 0.0);
    EXPECT_GT(row.bound.tiles, 0.0);
    EXPECT_EQ(row.bound.operations > 0.0, row.element != engine::Element::kSquare);
    // Eleven rows of a disk, twice.
    EXPECT_EQ(row.bound.counted.chords,
              row.element == engine::Element::kDisk ? 22.0 : row.bound.counted.chords);
    EXPECT_EQ(row.bound.counted.sums > 0.0, row.element == engine::Element::kBall);
  }
}

TEST(FiltersBench, OptionsOutOfRangeAreRefused) {
  const auto refused = [](auto&& spoil) {
    FiltersBenchOptions options;
    spoil(options);
    engine::JobControl job;
    const auto report = benchFilters(options, job);
    return !report && report.error().kind == engine::ErrorKind::kInput;
  };
  EXPECT_TRUE(refused([](FiltersBenchOptions& o) { o.side = 63; }));
  EXPECT_TRUE(refused([](FiltersBenchOptions& o) { o.windows = {4}; }));
  EXPECT_TRUE(refused([](FiltersBenchOptions& o) { o.windows = {1003}; }));
  EXPECT_TRUE(refused([](FiltersBenchOptions& o) { o.windows.clear(); }));
  EXPECT_TRUE(refused([](FiltersBenchOptions& o) { o.threads = {0}; }));
  EXPECT_TRUE(refused([](FiltersBenchOptions& o) { o.repeats = 0; }));
  EXPECT_TRUE(refused([](FiltersBenchOptions& o) { o.limit_s = 0.0; }));
}

}  // namespace
}  // namespace fettle::bench
