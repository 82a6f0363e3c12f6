#include "engine/shard/bands.h"

#include <gtest/gtest.h>

#include "engine/field/tile.h"
#include "engine/filter/catalogue.h"

namespace fettle::engine {
namespace {

Grid gridOf(std::int32_t width, std::int32_t height) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  return grid;
}

TEST(Bands, are_the_field_in_order_of_whole_tiles_and_about_equal) {
  for (const std::int32_t height : {1, 63, 64, 65, 1000, 262144})
    for (const int count : {1, 2, 3, 7, 16, 5000}) {
      std::int32_t row = 0, least = height, most = 0;
      for (int k = 1; k <= count; ++k) {
        const RowSpan band = bandOf(gridOf(10, height), {k, count});
        EXPECT_EQ(band.first, row);
        EXPECT_GE(band.count, 0);
        EXPECT_TRUE(band.count == 0 || band.first % kTileSide == 0);
        row = band.end();
        const std::int32_t tiles = (band.count + kTileSide - 1) / kTileSide;
        least = std::min(least, tiles), most = std::max(most, tiles);
      }
      EXPECT_EQ(row, height);
      EXPECT_LE(most - least, 1) << height << " rows, " << count;
    }
}

TEST(Bands, read_as_far_as_the_filter_reaches_and_begin_on_its_grid) {
  const Grid grid = gridOf(100, 2000);
  FilterSpec box;
  box.window = 9;
  box.passes = 3;
  EXPECT_EQ(rowsRead(grid, {640, 64}, box, false), (RowSpan{628, 88}));
  EXPECT_EQ(rowsRead(grid, {0, 64}, box, false), (RowSpan{0, 76}));
  EXPECT_EQ(rowsRead(grid, {1984, 16}, box, false), (RowSpan{1972, 28}));
  EXPECT_GT(rowsRead(grid, {640, 64}, box, true).count, 88);
  FilterSpec tgv;
  tgv.kind = FilterKind::kGeneralisedVariation;
  tgv.range_sigma = 1.0;
  EXPECT_EQ(rowsRead(grid, {1280, 64}, tgv, false).first % 256, 0);
  EXPECT_EQ(rowsRead(grid, {640, 64}, std::nullopt, true), (RowSpan{640, 64}));
}

TEST(Bands, the_fewest_shards_that_fit_are_found_or_none) {
  const Grid grid = gridOf(16384, 16384);
  FilterSpec box;
  const auto memoryOf = [&](int count) {
    std::uint64_t most = 0;
    for (int k = 1; k <= count; ++k) {
      const RowSpan own = bandOf(grid, {k, count});
      most = std::max(most, bandMemory(grid, own, rowsRead(grid, own, box, false), box, 2));
    }
    return most;
  };
  const int found = fewestShards(grid, box, false, 2, std::uint64_t{400} << 20);
  ASSERT_GT(found, 1);
  EXPECT_LE(memoryOf(found), std::uint64_t{400} << 20);
  EXPECT_GT(memoryOf(found - 1), std::uint64_t{400} << 20);
  EXPECT_EQ(fewestShards(grid, box, false, 2, 1 << 20), 0);
  EXPECT_EQ(fewestShards(grid, box, false, 2, std::uint64_t{1} << 40), 1);
  // Memory for exactly so many is enough for them.
  for (const int count : {1, 2, 7, found, 256})
    EXPECT_LE(fewestShards(grid, box, false, 2, memoryOf(count)), count);
}

TEST(Bands, filters_of_the_whole_field_are_known_as_such) {
  EXPECT_EQ(filterWords(needsWholeField), "robust-gaussian, spline and robust-spline");
}

}  // namespace
}  // namespace fettle::engine
