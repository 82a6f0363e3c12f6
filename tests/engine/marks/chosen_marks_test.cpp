#include "engine/marks/chosen_marks.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/measure/only_region.h"
#include "tests/support/no_data.h"

namespace fettle::engine {
namespace {

// 0.1 mm along x, 0.4 along y, far from the world's origin.
Version uneven(int width, int height) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  grid.spacing_x = 0.1;
  grid.spacing_y = 0.4;
  grid.origin_x = grid.origin_y = 5e6;
  std::vector<float> z(static_cast<std::size_t>(width) * height);
  for (std::size_t i = 0; i < z.size(); ++i) z[i] = i % 7 == 3 ? kNan : static_cast<float>(i);
  return makeField(grid, z);
}

TEST(ChosenMarks, has_the_samples_on_its_sides_in_any_order_of_corners) {
  const Grid grid = uneven(200, 90).grid();
  // 3 * 0.1 is a little more than 0.3.
  EXPECT_EQ(samplesBetween(grid, {0.3, 0.4}, {0.7, 2.0}), (SampleRect{3, 1, 5, 5}));
  EXPECT_EQ(samplesBetween(grid, {0.7, 0.4}, {0.3, 2.0}), (SampleRect{3, 1, 5, 5}));
  EXPECT_EQ(samplesBetween(grid, {-1e12, -1e12}, {1e12, 1e12}), (SampleRect{0, 0, 200, 90}));
  EXPECT_EQ(samplesBetween(grid, {0.3, 0.4}, {0.3, 0.4}), (SampleRect{3, 1, 1, 1}));
  EXPECT_TRUE(samplesBetween(grid, {0.31, 0.4}, {0.39, 2.0}).empty());
  EXPECT_TRUE(samplesBetween(grid, {-5.0, -5.0}, {-0.1, 30.0}).empty());
  EXPECT_TRUE(samplesBetween(grid, {19.95, 0.0}, {30.0, 30.0}).empty());
}

TEST(ChosenMarks, marks_its_samples_but_holes_and_no_others) {
  JobControl job;
  const Version before = uneven(200, 90);
  for (const SampleRect& rect :
       {SampleRect{3, 1, 5, 5}, {60, 60, 8, 8}, {0, 0, 200, 90}, {64, 0, 64, 64}, {199, 89, 1, 1}}) {
    const auto marked = onlyMarked(
        before, [&](std::int32_t tc, std::int32_t tr) { return rowsInside(rect, tc, tr); }, job);
    ASSERT_TRUE(marked);
    for (int r = 0; r < 90; ++r)
      for (int c = 0; c < 200; ++c) {
        const bool inside =
            c >= rect.column && c < rect.column + rect.columns && r >= rect.row && r < rect.row + rect.rows;
        ASSERT_EQ(marked->reader().markedAt(c, r), inside && (r * 200 + c) % 7 != 3) << c << "," << r;
      }
  }
}

TEST(ChosenMarks, other_samples_become_holes_and_marks_come_back) {
  JobControl job;
  const Version before = uneven(200, 90);
  const SampleRect rect{60, 60, 8, 8};
  const auto marked = onlyMarked(
      before, [&](std::int32_t tc, std::int32_t tr) { return rowsInside(rect, tc, tr); }, job);
  ASSERT_TRUE(marked);
  for (const Region region : {Region::kMarked, Region::kUnmarked}) {
    const auto only = onlyRegion(before, *marked, region, job);
    ASSERT_TRUE(only);
    std::int64_t heights = 0;
    for (int r = 0; r < 90; ++r)
      for (int c = 0; c < 200; ++c) {
        const bool stays = !std::isnan(before.reader().heightAt(c, r)) &&
                           marked->reader().markedAt(c, r) == (region == Region::kMarked);
        ASSERT_EQ(!std::isnan(only->reader().heightAt(c, r)), stays) << c << "," << r;
        heights += stays;
      }
    // Bounds follow: a sum of what tiles say.
    EXPECT_EQ(only->reader().bounds().empty(), heights == 0);
  }
  const auto again = withMarksFrom(*marked, before, job);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->reader().root().marked_children, 0U);
  EXPECT_EQ(onlyRegion(before, before, Region::kAll, job)->reader().tile(0, 0).samples.data(),
            before.reader().tile(0, 0).samples.data())
      << "tiles that lose nothing are shared";
}

}  // namespace
}  // namespace fettle::engine
