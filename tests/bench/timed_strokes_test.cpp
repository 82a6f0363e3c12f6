#include "bench/accuracy/timed_strokes.h"

#include <cmath>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

namespace fettle::bench {
namespace {

constexpr double kReach_s = 2.0;

engine::SimulatedScan steps() {
  auto scan = scanOf({"steps", "steps", 1.0}, 256, 1);
  EXPECT_TRUE(scan);
  return *std::move(scan);
}

// A place along points [first, last) of a true edge, `off` samples beside it.
engine::WorthPlace placeAt(const engine::SimulatedScan& scan, std::size_t edge, std::size_t first,
                           std::size_t last, double off) {
  engine::WorthPlace place;
  const double spacing = scan.scan.grid().spacingXMm();
  for (std::size_t i = first; i < last; ++i)
    place.path.push_back(scan.edge_lines[edge].points_mm[i] / spacing + glm::dvec2(off, 0.0));
  return place;
}

TEST(TimedStrokes, a_hand_draws_the_edge_that_a_place_shows_and_no_more) {
  const engine::SimulatedScan scan = steps();
  const DrawnEdges drawn = drawnEdges(scan, 1);
  const engine::WorthPlace place = placeAt(scan, 0, 20, 60, 1.0);
  const auto strokes = strokesAtPlaces(scan, drawn, std::vector{place}, kReach_s);
  ASSERT_EQ(strokes.size(), 1U);
  const std::size_t points = strokes[0].stroke.points.size();
  EXPECT_GE(points, 40U);
  EXPECT_LE(points, 40U + 2 * 10U) << "8 samples farther at both ends, a point about each";
  EXPECT_FALSE(strokes[0].stroke.closed);
  EXPECT_DOUBLE_EQ(strokes[0].begins_s, kReach_s);
  EXPECT_GT(strokes[0].ends_s, kReach_s);
}

TEST(TimedStrokes, where_no_edge_is_seen_or_all_is_drawn_only_time_is_lost) {
  const engine::SimulatedScan scan = steps();
  const DrawnEdges drawn = drawnEdges(scan, 1);
  engine::WorthPlace nowhere;
  for (int i = 0; i < 30; ++i) nowhere.path.emplace_back(126.0 + 0.1 * i, 127.5);
  const engine::WorthPlace place = placeAt(scan, 0, 20, 60, 0.0);
  const auto strokes = strokesAtPlaces(scan, drawn, std::vector{nowhere, place, place}, kReach_s);
  ASSERT_EQ(strokes.size(), 3U);
  EXPECT_TRUE(strokes[0].stroke.points.empty());
  EXPECT_DOUBLE_EQ(strokes[0].ends_s, kReach_s);
  EXPECT_FALSE(strokes[1].stroke.points.empty());
  EXPECT_TRUE(strokes[2].stroke.points.empty());
  EXPECT_DOUBLE_EQ(strokes[2].ends_s, strokes[1].ends_s + kReach_s);
}

TEST(TimedStrokes, by_length_the_longest_comes_first_and_an_unfinished_one_is_cut) {
  const engine::SimulatedScan scan = steps();
  const DrawnEdges drawn = drawnEdges(scan, 1);
  const auto strokes = strokesByLength(scan, drawn, kReach_s);
  ASSERT_EQ(strokes.size(), drawn.strokes.size());
  for (std::size_t i = 1; i < strokes.size(); ++i) {
    EXPECT_LE(strokes[i].ends_s - strokes[i].begins_s,
              strokes[i - 1].ends_s - strokes[i - 1].begins_s + 1e-9);
    EXPECT_DOUBLE_EQ(strokes[i].begins_s, strokes[i - 1].ends_s + kReach_s);
  }
  EXPECT_TRUE(drawnUntil(strokes, kReach_s).empty());
  const double middle = 0.5 * (strokes[1].begins_s + strokes[1].ends_s);
  const auto some = drawnUntil(strokes, middle);
  ASSERT_EQ(some.size(), 2U);
  EXPECT_EQ(some[0].points.size(), strokes[0].stroke.points.size());
  EXPECT_NEAR(static_cast<double>(some[1].points.size()),
              0.5 * static_cast<double>(strokes[1].stroke.points.size()), 2.0);
  EXPECT_EQ(drawnUntil(strokes, strokes.back().ends_s).size(), strokes.size());
}

}  // namespace
}  // namespace fettle::bench
