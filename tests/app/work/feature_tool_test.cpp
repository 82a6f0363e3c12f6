#include "app/work/feature_tool.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include <gtest/gtest.h>

#include "tests/app/work/loop_client_bench.h"
#include "tests/haptic/support/fields.h"
#include "tests/support/temp_folder.h"

namespace fettle::app {
namespace {

using tests::LoopClientBench;

constexpr int kSide = 60;
constexpr double kStep = 0.1;

// Two round hills of 1 and 0.5 mm on a plate that is tilted, and a pit of 0.8 mm.
double twoHills(int c, int r) {
  const auto bump = [&](double x, double y, double height) {
    return height * std::exp(-((c - x) * (c - x) + (r - y) * (r - y)) / 40.0);
  };
  return 0.002 * c + bump(15, 30, 1.0) + bump(45, 15, 0.5) - bump(42, 45, 0.8);
}

class FeatureToolTest : public ::testing::Test {
 protected:
  void find() {
    tool.find(bench.client());
    ASSERT_TRUE(bench.until([&] {
      (void)tool.poll(bench.client(), bench.noticesToFill());
      return !tool.busy();
    }));
  }
  LoopClientBench bench{tests::fieldOf(kSide, kSide, twoHills, kStep, kStep)};
  FeatureTool tool;
};

TEST_F(FeatureToolTest, hills_and_dales_are_found_and_nothing_of_the_field_changes) {
  tool.options.what.prune = 20.0;
  find();
  ASSERT_NE(tool.found(), nullptr) << (bench.notices().empty() ? "" : bench.notices().back().what);
  const Report& hills = (*tool.found())["features"];
  ASSERT_EQ(hills.size(), 2U);
  EXPECT_NEAR(hills[0]["x"].get<double>(), 1.5, 0.11);
  EXPECT_NEAR(hills[0]["y"].get<double>(), 3.0, 0.11);
  EXPECT_NEAR(hills[1]["x"].get<double>(), 4.5, 0.11);
  EXPECT_GT(hills[0]["height"].get<double>(), hills[1]["height"].get<double>());
  EXPECT_EQ(bench.client().history().number(), 0);
  EXPECT_FALSE(tool.outdated());

  tool.options.what.dales = true;
  find();
  const Report& dales = (*tool.found())["features"];
  ASSERT_GE(dales.size(), 1U);
  EXPECT_EQ((*tool.found())["kind"], "dales");
  EXPECT_NEAR(dales[0]["x"].get<double>(), 4.2, 0.11);
  EXPECT_NEAR(dales[0]["y"].get<double>(), 4.5, 0.11);
}

// What is coloured is a hill from its saddle up: as high as its row of the table says at the peak, 0 and more everywhere.
TEST_F(FeatureToolTest, colours_are_the_heights_above_saddles) {
  tool.options.what.prune = 20.0;
  for (const bool dales : {false, true}) {
    tool.options.what.dales = dales;
    find();
    ASSERT_NE(tool.found(), nullptr);
    const engine::Version field = bench.client().field();
    const engine::Version* const saddles = tool.saddles(field);
    ASSERT_NE(saddles, nullptr);
    const engine::FieldReader heights = field.reader(), from = saddles->reader();
    double most = 0.0;
    int coloured = 0;
    for (int r = 0; r < kSide; ++r)
      for (int c = 0; c < kSide; ++c) {
        const double above =
            static_cast<double>(heights.heightAt(c, r)) - static_cast<double>(from.heightAt(c, r));
        if (std::isnan(above)) continue;
        ++coloured;
        const double out = dales ? -above : above;
        EXPECT_GE(out, -1e-6) << c << ' ' << r;
        most = std::max(most, out);
      }
    EXPECT_NEAR(most, (*tool.found())["features"][0]["height"].get<double>(), 1e-5);
    EXPECT_GT(coloured, 20);
  }
}

TEST_F(FeatureToolTest, writes_a_row_for_each_and_says_what_it_cannot_find) {
  tool.options.what.prune = 20.0;
  find();
  const tests::TempFolder folder;
  ASSERT_TRUE(writeFeatures(*tool.found(), folder.file("f.csv")));
  const std::string text = featureCsv(*tool.found());
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3) << text;
  tool.options.what.region = engine::Region::kMarked;
  find();
  ASSERT_FALSE(bench.notices().empty());
  EXPECT_EQ(bench.notices().back().what, "nothing is marked that has a height");
  EXPECT_NE(bench.notices().back().remedy.find("mark samples"), std::string::npos);
}

}  // namespace
}  // namespace fettle::app
