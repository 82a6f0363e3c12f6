// Holes that a file means and hardly says: in the description of a PNG that Fettle wrote, and as one number
// far from every height.

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "engine/filter/filter.h"
#include "tests/engine/io/io_support.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

// 100 x 100 samples of which 500 hold `value`; the others lie between 10 and 15.
std::vector<float> with500(float value) {
  std::mt19937 random(8);
  std::vector<float> z(10000);
  for (std::size_t i = 0; i < z.size(); ++i)
    z[i] = i % 20 == 7 ? value : 10.0F + static_cast<float>(random() % 5000) * 0.001F;
  return z;
}

TEST(UndeclaredHoles, ThoseOfAPngThatFettleWroteAreHolesWhenItIsReadBack) {
  const TempFolder folder;
  for (const double per_count : {0.0, 0.002}) {
    Grid grid = gridOf(100, 100);
    grid.height_per_count = per_count;
    const Version field = makeField(grid, with500(kNan));
    ASSERT_TRUE(save(field, folder.file("holes.png")));
    FETTLE_LOAD(again, folder.file("holes.png"));
    EXPECT_EQ(summarize(again.field).no_data, 500);
    EXPECT_GE(summarize(again.field).min, 1.0);
    EXPECT_TRUE(warned(again.warnings, "the file says height = ")) << "the way to heights is not said";
    EXPECT_FALSE(warned(again.warnings, "--no-data"));
    // So that a filter leaves them alone, and no neighbour takes one for a height.
    FilterSpec spec;
    spec.window = 3;
    JobControl job;
    const auto filtered = applyFilter(again.field, again.field, spec, job);
    ASSERT_TRUE(filtered) << filtered.error().line();
    EXPECT_EQ(summarize(filtered->field).no_data, 500);
    EXPECT_GE(summarize(filtered->field).min, summarize(again.field).min);
  }
}

TEST(UndeclaredHoles, APngWithoutHolesHasNoneThoughAHeightIsCountedAs0) {
  const TempFolder folder;
  Grid grid = gridOf(100, 100);
  grid.height_per_count = 0.5;
  std::vector<float> z;
  for (int i = 0; i < 10000; ++i) z.push_back(static_cast<float>(i % 100) * 0.5F);
  ASSERT_TRUE(save(makeField(grid, z), folder.file("whole.png")));
  FETTLE_LOAD(again, folder.file("whole.png"));
  EXPECT_EQ(summarize(again.field).no_data, 0);
  EXPECT_EQ(summarize(again.field).min, 0.0);
}

TEST(UndeclaredHoles, ALoneValueFarFromAllOthersIsSaidWithTheOptionThatTakesItOut) {
  const TempFolder folder;
  for (const auto& [value, option] :
       {std::pair{0.0F, "--no-data 0"}, {-9999.0F, "--no-data -9999"}, {999.0F, "--no-data 999"}}) {
    for (const char* name : {"lone.tif", "lone.xyz", "lone.exr"}) {
      SCOPED_TRACE(std::string(name) + " " + option);
      ASSERT_TRUE(save(makeField(gridOf(100, 100), with500(value)), folder.file(name)));
      FETTLE_LOAD(scan, folder.file(name));
      EXPECT_EQ(summarize(scan.field).no_data, 0);
      EXPECT_TRUE(warned(scan.warnings, option));
      EXPECT_TRUE(warned(scan.warnings, "5 % of the samples"));
      ImportOptions options;
      options.no_data = value;
      FETTLE_LOAD(without, folder.file(name), options);
      EXPECT_EQ(summarize(without.field).no_data, 500);
      EXPECT_FALSE(warned(without.warnings, "--no-data"));
    }
  }
}

TEST(UndeclaredHoles, TheOptionIsInTheNumbersThatTheFileStores) {
  const TempFolder folder;
  // Counts of 0.1 each, 0 between them at none.
  std::string text;
  for (int r = 0; r < 30; ++r)
    for (int c = 0; c < 30; ++c)
      text += std::to_string(c) + " " + std::to_string(r) + " " +
              std::to_string(c % 9 == 4 ? -32000 : 100 + (c * 7 + r * 3) % 50) + "\n";
  writeBytes(folder.file("counts.xyz"), text);
  ImportOptions options;
  options.z_scale = 0.1;
  FETTLE_LOAD(scan, folder.file("counts.xyz"), options);
  EXPECT_TRUE(warned(scan.warnings, "exactly -3200 mm"));
  EXPECT_TRUE(warned(scan.warnings, "--no-data -32000"));
}

TEST(UndeclaredHoles, SurfacesThatHaveAFlatAreNotDoubted) {
  const TempFolder folder;
  std::vector<float> steps, few, ground, rare, part;
  std::mt19937 random(3);
  for (int i = 0; i < 10000; ++i) {
    const float noise = static_cast<float>(random() % 1000) * 0.001F;
    steps.push_back(static_cast<float>(i % 7) * 10.0F);      // few levels, each held by many
    few.push_back(i % 5 == 0 ? 0.0F : 3.0F + noise * 0.0F);  // two levels
    ground.push_back(i % 3 == 0 ? 0.0F : noise);             // a flat that the rest comes down to
    rare.push_back(i % 200 == 0 ? -50.0F : noise);           // half a percent
    // Two flats and what lies between them, without noise: a part as it is designed.
    part.push_back(i % 5 < 2 ? 0.0F : i % 5 == 2 ? 18.0F : 8.0F + noise * 10.0F);
  }
  for (const std::vector<float>& z : {steps, few, ground, rare, part}) {
    ASSERT_TRUE(save(makeField(gridOf(100, 100), z), folder.file("flat.tif")));
    FETTLE_LOAD(scan, folder.file("flat.tif"));
    EXPECT_FALSE(warned(scan.warnings, "--no-data")) << scan.warnings.front();
  }
}

}  // namespace
}  // namespace fettle::engine
