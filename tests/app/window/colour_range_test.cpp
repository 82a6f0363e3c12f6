#include "app/window/colour_range.h"

#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "engine/field/builder.h"

namespace fettle::app {
namespace {

using RuleKind = RangeRule::Kind;

// Heights from 0 to 99, or with `change` added in the left tenth.
engine::Version rampOf(double change = 0.0) {
  engine::Grid grid;
  grid.width = 100;
  grid.height = 100;
  std::vector<float> z;
  for (int r = 0; r < 100; ++r)
    for (int c = 0; c < 100; ++c) z.push_back(static_cast<float>(c + (c < 10 ? change : 0.0)));
  return engine::makeField(grid, z, {});
}

void waitFor(ColourRange& colours, const render::Shown& shown) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!colours.poll(shown, true, false)) {
    ASSERT_LT(std::chrono::steady_clock::now(), end);
    std::this_thread::yield();
  }
}

TEST(ColourRange, follows_its_rule_and_what_is_shown) {
  ColourRange colours;
  Display display;
  render::Shown shown;
  shown.versions = {rampOf()};
  EXPECT_FALSE(ColourRange::needsSample(display, shown));
  EXPECT_FALSE(colours.range(display, shown)) << "automatic: the picture finds it";
  display.heights = {RuleKind::kAll, 0.5};
  EXPECT_TRUE(ColourRange::needsSample(display, shown));
  EXPECT_FALSE(colours.poll(shown, true, true)) << "not while a brush works";
  EXPECT_FALSE(colours.busy());
  waitFor(colours, shown);
  EXPECT_EQ(colours.range(display, shown), (render::ValueRange{0, 99}));
  display.heights.kind = RuleKind::kShare;
  EXPECT_NEAR(colours.range(display, shown)->low, 25, 1);
  EXPECT_NEAR(colours.range(display, shown)->high, 74, 1);
  display.heights.kind = RuleKind::kAll;
  shown.versions = {rampOf().inverted()};
  EXPECT_EQ(colours.range(display, shown), (render::ValueRange{-99, 0})) << "before it is counted again";
  // Of changes no sample is there yet; then only what changed counts.
  shown.original = rampOf();
  shown.versions = {rampOf(-3.0)};
  display.changes.kind = RuleKind::kAll;
  EXPECT_FALSE(colours.range(display, shown));
  waitFor(colours, shown);
  EXPECT_EQ(colours.sample(render::Quantity::kDeviation)->sorted.size(), 1000U);
  EXPECT_EQ(colours.sample(render::Quantity::kHeight), nullptr);
  EXPECT_EQ(colours.range(display, shown)->low, -3.0);
}

TEST(ColourRange, what_is_typed_keeps_its_samples_upside_down_and_ends_with_the_scan) {
  ColourRange colours;
  Display display;
  render::Shown shown;
  shown.versions = {rampOf()};
  colours.type(display, shown, {10, 30});
  EXPECT_EQ(display.heights.kind, RuleKind::kTyped);
  EXPECT_EQ(colours.range(display, shown), (render::ValueRange{10, 30}));
  shown.versions = {rampOf().inverted()};
  EXPECT_EQ(colours.range(display, shown), (render::ValueRange{-30, -10}));
  shown.original = shown.versions.front();
  EXPECT_FALSE(colours.range(display, shown)) << "of heights alone";
  colours.type(display, shown, {-0.5, 0.5});
  colours.typed.tolerance = 0.1;
  colours.typed.change_contours = 0.25;
  EXPECT_EQ(colours.range(display, shown), (render::ValueRange{-0.5, 0.5}));
  EXPECT_EQ(colours.colouring(display, render::Quantity::kDeviation).tolerance, 0.1);
  EXPECT_EQ(colours.colouring(display, render::Quantity::kDeviation).contour_step, 0.25);
  EXPECT_EQ(colours.colouring(display, render::Quantity::kHeight).contour_step, 0.0);
  colours.clear(display);
  EXPECT_EQ(display.heights.kind, RuleKind::kAutomatic);
  EXPECT_EQ(display.changes.kind, RuleKind::kAutomatic);
  EXPECT_FALSE(colours.range(display, shown));
  EXPECT_EQ(colours.typed.tolerance, 0.0);
}

TEST(ColourRange, what_has_a_sign_has_the_map_with_a_middle) {
  const ColourRange colours;
  Display display;
  for (const render::ColourMap map : {render::ColourMap::kAuto, render::ColourMap::kViridis,
                                      render::ColourMap::kCividis, render::ColourMap::kGrey}) {
    display.map = map;
    EXPECT_EQ(colours.colouring(display, render::Quantity::kHeight).map, map);
    EXPECT_EQ(colours.colouring(display, render::Quantity::kOneSign).map, map);
    EXPECT_EQ(colours.colouring(display, render::Quantity::kDeviation).map, render::ColourMap::kDiverging);
  }
}

TEST(ColourRange, a_difference_of_one_sign_has_the_limit_of_changes) {
  ColourRange colours;
  Display display;
  render::Shown shown;
  shown.versions = {rampOf(3.0)};
  shown.original = rampOf();
  shown.difference = {"hill height", true};
  EXPECT_EQ(ColourRange::quantityOf(shown), render::Quantity::kOneSign);
  colours.type(display, shown, {0.0, 2.0});
  EXPECT_EQ(display.heights.kind, RuleKind::kAutomatic);
  EXPECT_EQ(display.changes.kind, RuleKind::kTyped);
  EXPECT_EQ(colours.range(display, shown), (render::ValueRange{-2, 2})) << "the picture takes its half";
  colours.type(display, shown, {-1.5, 0.0});
  EXPECT_EQ(colours.range(display, shown)->high, 1.5);
}

}  // namespace
}  // namespace fettle::app
