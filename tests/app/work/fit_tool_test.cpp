#include "app/work/fit_tool.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "tests/app/work/loop_client_bench.h"
#include "tests/haptic/support/fields.h"
#include "tests/support/temp_folder.h"

namespace fettle::app {
namespace {

using tests::LoopClientBench;

constexpr int kFittedWide = 90, kFittedHigh = 60;
constexpr double kRise = 0.05;  // of the right half, per millimetre

// Two planes that meet in the middle, with noise of 1 um, and a line where they meet.
engine::Version roof() {
  std::mt19937_64 random(7);
  engine::Version field = tests::fieldOf(
      kFittedWide, kFittedHigh,
      [&](int c, int) {
        const double beyond_mm = 0.1 * std::max(0, c - kFittedWide / 2);
        return kRise * beyond_mm + 0.001 * tests::uniform(random, -1.0, 1.0);
      },
      0.1, 0.1);
  engine::EdgeLine line;
  for (int r = 0; r < kFittedHigh; ++r) line.points.push_back({.position = {kFittedWide / 2.0, r}});
  return field.withLines(std::make_shared<const std::vector<engine::EdgeLine>>(std::vector{line}));
}

class FitToolTest : public ::testing::Test {
 protected:
  bool rest() {
    return bench.until([&] {
      (void)tool.poll(bench.client(), bench.noticesToFill());
      return !tool.busy();
    });
  }
  tests::TempFolder folder;
  LoopClientBench bench{roof()};
  FitTool tool;
};

TEST_F(FitToolTest, each_region_between_edge_lines_has_its_fit_and_two_have_an_angle) {
  tool.fit(bench.client());
  ASSERT_TRUE(rest());
  ASSERT_NE(tool.fits(), nullptr) << (bench.notices().empty() ? "" : bench.notices().back().what);
  const FieldFits& fits = *tool.fits();
  ASSERT_EQ(fits.fitted.size(), 2U);
  for (const FittedRegion& one : fits.fitted)
    EXPECT_EQ(one.chosen.fit.shape.kind, engine::ShapeKind::kPlane) << one.number;
  ASSERT_TRUE(tool.pair());
  const Report& between = fits.report["between"];
  const double angle = std::atan(kRise) * 180.0 / M_PI;
  // Five of its standard errors: less than once in a million.
  EXPECT_NEAR(between["angle_deg"].get<double>(), angle, 5.0 * between["angle_error_deg"].get<double>());
  EXPECT_FALSE(tool.outdated());
  EXPECT_EQ(bench.client().history().number(), 0) << "nothing of the field changed";
}

TEST_F(FitToolTest, colours_are_the_distances_and_holes_where_nothing_was_fitted) {
  tool.fit(bench.client());
  ASSERT_TRUE(rest());
  const engine::Version now = bench.client().field();
  const engine::Version* const surface = tool.surface(now);
  ASSERT_NE(surface, nullptr);
  const engine::FieldReader heights = now.reader(), plane = surface->reader();
  for (int c = 0; c < kFittedWide; ++c) {
    const double away = static_cast<double>(heights.heightAt(c, 30) - plane.heightAt(c, 30));
    const int from_line = std::abs(c - kFittedWide / 2);
    if (from_line < 2) {
      EXPECT_TRUE(std::isnan(away)) << "beside the line, at " << c;
    } else if (from_line > 3) {
      EXPECT_LT(std::abs(away), 0.002) << c;
    }
  }
}

TEST_F(FitToolTest, without_regard_to_lines_all_samples_are_one_region) {
  tool.options.between_lines = false;
  tool.options.shape = engine::ShapeKind::kPlane;
  tool.fit(bench.client());
  ASSERT_TRUE(rest());
  ASSERT_NE(tool.fits(), nullptr);
  ASSERT_EQ(tool.fits()->fitted.size(), 1U);
  EXPECT_EQ(tool.fits()->fitted.front().region.samples, std::int64_t{kFittedWide} * kFittedHigh);
  EXPECT_FALSE(tool.pair());
  EXPECT_FALSE(tool.fits()->warnings.empty()) << "a roof is no plane";
  tool.clear();
  EXPECT_EQ(tool.fits(), nullptr);
}

TEST_F(FitToolTest, nothing_to_fit_to_is_said) {
  tool.options.region = engine::Region::kMarked;
  tool.options.between_lines = false;
  tool.fit(bench.client());
  ASSERT_TRUE(rest());
  EXPECT_EQ(tool.fits(), nullptr);
  ASSERT_EQ(bench.notices().size(), 1U);
  EXPECT_EQ(bench.notices().front().what, "nothing is marked that has a height");
  EXPECT_EQ(bench.notices().front().remedy, "mark samples, or take all of them");
}

TEST_F(FitToolTest, fits_are_written_by_the_ending) {
  tool.fit(bench.client());
  ASSERT_TRUE(rest());
  ASSERT_NE(tool.fits(), nullptr);
  const auto written = [&](const char* name) {
    EXPECT_TRUE(writeFits(*tool.fits(), tool.field(), folder.file(name)));
    std::ifstream in(folder.file(name));
    return std::string(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  };
  EXPECT_TRUE(written("f.csv").starts_with("region,shape,figure,value,standard_error,unit,layer\n1,plane,"));
  const Report report = Report::parse(written("f.json"));
  EXPECT_EQ(report["schema"], "fettle.fit/1");
  EXPECT_EQ(report["fits"].size(), 2U);
  EXPECT_EQ(report["between"], tool.fits()->report["between"]);
  EXPECT_TRUE(written("f.step").starts_with("ISO-10303-21;"));
  EXPECT_EQ(written("f.step"), written("f.stp"));
  const auto refused = writeFits(*tool.fits(), tool.field(), folder.file("f.xyz"));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, engine::ErrorKind::kInput);
}

}  // namespace
}  // namespace fettle::app
