
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "engine/compare/compare.h"
#include "engine/field/builder.h"

namespace fettle::engine {
namespace {

Version fieldOf(const Grid& grid, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<float> z;
  for (std::int64_t i = 0; i < grid.samples(); ++i)
    z.push_back(random() % 17 == 0 ? NAN : static_cast<float>(random() % 100000) * 0.001F);
  return makeField(grid, z);
}

TEST(DeviationField, IsTheDifferenceOfEachSampleRoundedOnce) {
  Grid grid;
  grid.width = 131;
  grid.height = 67;
  grid.origin_x = 5e6 + 0.125;
  grid.spacing_y = 0.25;
  grid.lateral_unit = grid.height_unit = {"um", 1e-3};
  grid.height_per_count = 0.02;
  grid.crs_wkt = "LOCAL_CS[\"here\"]";
  const Version a = fieldOf(grid, 1);
  Grid other = grid;
  other.height_unit = {"mm", 1.0};
  const Version b = fieldOf(other, 2).inverted();
  JobControl job;
  const auto deviation = deviationField(a, b, job);
  ASSERT_TRUE(deviation);
  Grid expected = grid;
  expected.height_per_count = 0.0;
  EXPECT_EQ(deviation->grid(), expected);
  double largest = 0.0;
  for (int r = 0; r < 67; ++r)
    for (int c = 0; c < 131; ++c) {
      const double d = b.reader().heightAt(c, r) * (1.0 / 1e-3) - double{a.reader().heightAt(c, r)};
      const float found = deviation->reader().heightAt(c, r);
      if (std::isnan(d)) {
        EXPECT_TRUE(std::isnan(found));
      } else {
        EXPECT_EQ(found, static_cast<float>(d));
        largest = std::max(largest, std::abs(d));
      }
    }
  const auto figures = compareFields(a, b, job);
  ASSERT_TRUE(figures);
  EXPECT_EQ(figures->max_abs, largest);
  EXPECT_EQ(summarize(*deviation).no_data, grid.samples() - figures->samples);
}

TEST(DeviationField, RefusesSizesThatDifferAndCanBeCancelled) {
  Grid grid;
  grid.width = 4;
  grid.height = 3;
  const Version a = fieldOf(grid, 1);
  grid.height = 4;
  const Version b = fieldOf(grid, 1);
  JobControl job;
  const auto refused = deviationField(a, b, job);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kInput);
  job.cancel();
  const auto stopped = deviationField(a, a, job);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::engine
