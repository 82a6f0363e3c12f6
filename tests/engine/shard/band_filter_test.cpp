// The bands of any number of shards are the field that one run makes, bit by bit.
#include "engine/shard/band_filter.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/edge_line.h"
#include "engine/field/piece.h"
#include "engine/field/tile.h"
#include "engine/filter/catalogue.h"
#include "engine/shard/bands.h"
#include "tests/engine/shard/shard_field.h"

namespace fettle::engine {
namespace {

FilterSpec specOf(const Filter& filter) {
  FilterSpec spec;
  spec.kind = filter.kind;
  if (filter.window.exists()) spec.window = 7;
  if (filter.range_sigma.exists()) spec.range_sigma = 0.03;
  if (filter.nesting.exists()) spec.nesting_mm = 12.0;
  return spec;
}

struct Gathered {
  std::vector<float> z;
  BandReport report;
};

Gathered gathered(const Version& field, const Version& original, const FilterSpec& spec, int count) {
  const Grid& grid = field.grid();
  // Pieces have the sign applied.
  const Version seen = field.reader().sign() == original.reader().sign() ? original : original.inverted();
  Gathered all;
  all.z.resize(static_cast<std::size_t>(grid.samples()));
  for (int k = 1; k <= count; ++k) {
    const RowSpan own = bandOf(grid, {k, count});
    if (own.count == 0) continue;
    const RowSpan read = rowsRead(grid, own, spec, field.lines() != nullptr);
    JobControl job;
    std::int32_t next = own.first;
    const auto done = filterBand(
        rowsOf(field, read.first, read.count), rowsOf(seen, read.first, read.count), &spec, read, own,
        [&](std::int32_t row, std::int32_t rows, const float* heights) -> Status {
          EXPECT_EQ(row, next);
          next += rows;
          std::copy_n(heights, static_cast<std::size_t>(rows) * static_cast<std::size_t>(grid.width),
                      all.z.begin() + std::ptrdiff_t{row} * grid.width);
          return {};
        },
        job);
    EXPECT_TRUE(done) << done.error().line();
    EXPECT_EQ(next, own.end());
    if (!done) continue;
    all.report.samples += done->samples;
    all.report.changed += done->changed;
    all.report.max_change = std::max(all.report.max_change, done->max_change);
    all.report.squares += done->squares;
  }
  return all;
}

void expectEqual(const Version& field, const Version& original, const FilterSpec& spec,
                 std::initializer_list<int> counts) {
  JobControl job;
  const auto whole = applyFilter(field, original, spec, job);
  ASSERT_TRUE(whole) << whole.error().line();
  const Grid& grid = field.grid();
  std::vector<float> z(static_cast<std::size_t>(grid.samples()));
  whole->field.reader().readHeights(0, 0, grid.width, grid.height, z.data(), grid.width);
  // A hole of an inverted field is a NaN with the other sign, which nothing looks at.
  for (float& height : z)
    if (height != height) height = std::numeric_limits<float>::quiet_NaN();
  for (const int count : counts) {
    const Gathered all = gathered(field, original, spec, count);
    EXPECT_EQ(std::memcmp(all.z.data(), z.data(), z.size() * sizeof(float)), 0)
        << name(spec.kind) << ", " << count << " shards";
    EXPECT_EQ(all.report.changed, whole->report.changed) << name(spec.kind);
    EXPECT_EQ(all.report.max_change, whole->report.max_change);
    // Sums of n squares in another order, each rounded once: n / 2 ulp at most, here about 1e-11.
    EXPECT_NEAR(std::sqrt(all.report.squares / static_cast<double>(all.report.samples)),
                whole->report.rms_change, 1e-10 * whole->report.rms_change);
  }
}

TEST(BandFilter, any_number_of_shards_has_the_bits_of_one_run_with_every_filter_that_can_be_divided) {
  const Version field = tests::hardField(70, 720);
  int tried = 0;
  for (const Filter& filter : filters()) {
    if (needsWholeField(filter)) continue;
    expectEqual(field, field, specOf(filter), {1, 2, 3, 7, 16});
    ++tried;
  }
  EXPECT_EQ(tried, 11);
}

TEST(BandFilter, with_several_passes_a_limit_and_an_inverted_field_too) {
  const Version field = tests::hardField(130, 400);
  FilterSpec spec;
  spec.window = 5;
  spec.passes = 4;
  spec.max_change = 0.02;
  expectEqual(field.inverted(), field, spec, {3});
  spec.kind = FilterKind::kMedian;
  spec.scope = FilterScope::kOnlyMarks;
  expectEqual(field, field, spec, {2, 5});
}

TEST(BandFilter, keeps_to_edge_lines_that_cross_the_bands) {
  auto line = std::make_shared<std::vector<EdgeLine>>();
  EdgeLine steep;
  for (int i = 0; i < 380; ++i) {
    EdgePoint point;
    point.position = {30.0 + 0.1 * i, 10.3 + i};
    steep.points.push_back(point);
  }
  line->push_back(steep);
  const Version field = tests::hardField(130, 400).withLines(line);
  for (const FilterKind kind : {FilterKind::kMedian, FilterKind::kGeneralisedVariation})
    expectEqual(field, field, specOf(filterOf(kind)), {2, 7});
}

TEST(BandFilter, a_cancel_and_an_error_of_what_takes_the_rows_end_it) {
  const Version field = tests::hardField(90, 200);
  const FilterSpec spec;
  JobControl job;
  const auto refused = filterBand(
      field, field, &spec, {0, 200}, {64, 64},
      [](std::int32_t, std::int32_t, const float*) { return Status(failure("full", "disk")); }, job);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().what, "full");
  job.cancel();
  const auto ended = filterBand(
      field, field, &spec, {0, 200}, {64, 64},
      [](std::int32_t, std::int32_t, const float*) { return Status(); }, job);
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::engine
