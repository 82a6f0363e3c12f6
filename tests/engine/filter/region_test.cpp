#include "engine/filter/region.h"

#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"

namespace fettle::engine {
namespace {

Version roughField(int width, int height) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  std::mt19937 random(4);
  std::vector<float> z;
  std::vector<std::uint8_t> marks;
  for (int i = 0; i < width * height; ++i) {
    z.push_back(random() % 40 == 0 ? std::numeric_limits<float>::quiet_NaN()
                                   : static_cast<float>(random() % 1000) * 1e-3F);
    marks.push_back(random() % 30 == 0);
  }
  return makeField(grid, z, marks);
}

std::int64_t differing(const Version& a, const Version& b, TileRange in, bool inside) {
  std::int64_t n = 0;
  for (int r = 0; r < a.grid().height; ++r)
    for (int c = 0; c < a.grid().width; ++c) {
      const int tc = c / kTileSide, tr = r / kTileSide;
      const bool here =
          tc >= in.column && tc < in.column + in.columns && tr >= in.row && tr < in.row + in.rows;
      if (here != inside) continue;
      const float x = a.reader().heightAt(c, r), y = b.reader().heightAt(c, r);
      n += !(x == y || (x != x && y != y));
    }
  return n;
}

TEST(FilterRange, gives_the_bits_of_the_whole_filter_there_and_leaves_the_rest) {
  const Version field = roughField(330, 260);
  JobControl job;
  FilterSpec specs[6];
  specs[0].window = 9;
  specs[1].kind = FilterKind::kGaussian;
  specs[1].window = 5;
  specs[1].passes = 4;
  specs[2].kind = FilterKind::kMedian;
  specs[2].window = 31;
  specs[2].scope = FilterScope::kOnlyMarks;
  specs[3].kind = FilterKind::kMedian;
  specs[3].window = 5;
  specs[3].max_change = 0.05;
  specs[4].kind = FilterKind::kBilateral;
  specs[4].window = 7;
  specs[4].passes = 2;
  specs[4].range_sigma = 0.1;
  specs[5].kind = FilterKind::kTotalVariation;
  specs[5].window = 21;
  specs[5].passes = 2;
  specs[5].range_sigma = 0.1;
  for (const Version& input : {field, field.inverted()})
    for (const FilterSpec& spec : specs) {
      const Version whole = applyFilter(input, field, spec, job)->field;
      Version so_far = input;
      for (const TileRange& range : {TileRange{1, 1, 2, 1}, {0, 0, 1, 5}, {4, 3, 9, 9}, {-3, 2, 4, 1}}) {
        const Version before = so_far;
        so_far = *filterRange(input, field, so_far, spec, range, job);
        EXPECT_EQ(differing(so_far, whole, range, true), 0);
        EXPECT_EQ(differing(so_far, before, range, false), 0);
      }
      so_far = *filterRange(input, field, so_far, spec, allTiles(field.grid()), job);
      EXPECT_EQ(contentHash(so_far), contentHash(whole));
    }
}

TEST(FilterRange, a_range_outside_the_field_changes_nothing_and_a_wrong_spec_is_refused) {
  const Version field = roughField(100, 100);
  JobControl job;
  FilterSpec spec;
  EXPECT_EQ(*filterRange(field, field, field, spec, {5, 5, 2, 2}, job), field);
  EXPECT_EQ(*filterRange(field, field, field, spec, {0, 0, 0, 2}, job), field);
  spec.window = 4;
  EXPECT_EQ(filterRange(field, field, field, spec, {0, 0, 1, 1}, job).error().kind, ErrorKind::kInput);
}

}  // namespace
}  // namespace fettle::engine
