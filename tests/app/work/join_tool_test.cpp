#include "app/work/join_tool.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "engine/formats/formats.h"
#include "tests/app/work/loop_client_bench.h"
#include "tests/haptic/support/fields.h"
#include "tests/support/temp_folder.h"

namespace fettle::app {
namespace {

using tests::LoopClientBench;

constexpr int kWide = 96, kHigh = 80, kFrom = 60;  // the second scan begins at this column of the first
constexpr double kJoinStep = 0.1;                  // [mm]

// No part of it is like another, and it is tilted by nothing.
double unlikeHills(double c, double r) {
  return 0.3 * std::sin(0.11 * c + 0.002 * r * c) + 0.2 * std::cos(0.17 * r) +
         0.15 * std::sin(0.05 * c * c / 40.0 + 0.3 * r / 4.0);
}

engine::Version partFrom(int column, double raised) {
  return tests::fieldOf(
      kWide, kHigh, [&](int c, int r) { return unlikeHills(c + column, r) + raised; }, kJoinStep, kJoinStep);
}

float heightAt(const engine::Version& field, int column, int row) {
  float height = 0.0F;
  field.reader().readHeights(column, row, 1, 1, &height, 1);
  return height;
}

class JoinToolTest : public ::testing::Test {
 protected:
  void add(const engine::Version& scan, const char* name) {
    engine::JobControl job;
    ASSERT_TRUE(engine::exportField(scan, folder.file(name), {}, job));
    tool.add({folder.file(name), {}});
  }
  std::optional<std::string> written() {
    std::optional<std::string> path;
    EXPECT_TRUE(bench.until([&] {
      if (auto done = tool.poll(bench.noticesToFill())) path = done;
      return !tool.busy();
    }));
    return path;
  }
  tests::TempFolder folder;
  std::string out = folder.file("all.fettle");
  LoopClientBench bench{partFrom(0, 0.0)};
  JoinTool tool;
};

TEST_F(JoinToolTest, AScanThatLiesBesideAndHigherIsLaidOntoTheFieldAndContinuesIt) {
  add(partFrom(kFrom, 0.7), "east.tif");
  tool.options.columns = 2;
  tool.options.overlap = 100.0 * (kWide - kFrom) / kWide;
  tool.write(bench.client(), out);
  ASSERT_EQ(written(), out) << (bench.notices().empty() ? "" : bench.notices().back().what);
  EXPECT_NE(bench.notices().back().what.find("2 scans joined by 1 overlaps"), std::string::npos)
      << bench.notices().back().what;
  engine::JobControl job;
  const auto read = engine::importField(out, {}, job);
  ASSERT_TRUE(read);
  const engine::Grid& grid = read->field.grid();
  EXPECT_GE(grid.width, kFrom + kWide - 1);
  EXPECT_EQ(heightAt(read->field, 0, 0), heightAt(bench.client().field(), 0, 0));
  double worst = 0.0;
  for (int r = 4; r < kHigh - 4; ++r)
    for (int c = 0; c < kFrom + kWide - 4; ++c)
      worst = std::max(worst, std::abs(heightAt(read->field, c, r) - unlikeHills(c, r)));
  // Bilinear between samples where the found place is off by a small part of a step: curvature over eight, 0.0005 mm here.
  EXPECT_LT(worst, 2e-3);
  EXPECT_EQ(bench.client().history().number(), 0);
}

TEST_F(JoinToolTest, AScanOfAnotherPartIsRefusedByItsNameAndNothingIsWritten) {
  add(tests::fieldOf(
          kWide, kHigh, [](int, int) { return 1.0; }, kJoinStep, kJoinStep),
      "plate.tif");
  tool.write(bench.client(), out);
  EXPECT_FALSE(written());
  ASSERT_FALSE(bench.notices().empty());
  EXPECT_NE(bench.notices().back().what.find("plate.tif"), std::string::npos) << bench.notices().back().what;
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(JoinToolTest, RowsThatTheScansDoNotFillAreRefused) {
  add(partFrom(kFrom, 0.0), "east.tif");
  tool.options.columns = 3;
  tool.write(bench.client(), out);
  EXPECT_FALSE(written());
  EXPECT_NE(bench.notices().back().what.find("2 scans do not fill rows of 3"), std::string::npos);
}

TEST_F(JoinToolTest, WhatIsCancelledLeavesNoFileAndNoNotice) {
  add(partFrom(kFrom, 0.0), "east.tif");
  tool.write(bench.client(), out);
  tool.cancel();
  EXPECT_FALSE(written());
  EXPECT_TRUE(bench.notices().empty());
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(JoinToolTest, AListedScanIsTakenOffTheList) {
  add(partFrom(kFrom, 0.0), "east.tif");
  add(partFrom(kFrom, 0.0), "west.tif");
  tool.remove(0);
  ASSERT_EQ(tool.scans().size(), 1U);
  EXPECT_TRUE(tool.scans()[0].path.ends_with("west.tif"));
  tool.clear();
  tool.write(bench.client(), out);
  EXPECT_FALSE(written());
  EXPECT_NE(bench.notices().back().what.find("no other scan"), std::string::npos);
}

}  // namespace
}  // namespace fettle::app
