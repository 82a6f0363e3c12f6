#include "engine/edges/neighbours.h"

#include <cmath>

#include <gtest/gtest.h>

#include "engine/edges/separate.h"
#include "engine/edges/surroundings.h"
#include "tests/engine/edges/edge_fields.h"

namespace fettle::engine {
namespace {

Polyline along(double row, double wave = 0.0) {
  std::vector<glm::dvec2> points = straightStroke({0.0, row}, {200.0, row});
  for (glm::dvec2& p : points) p.y += wave * std::sin(p.x / 5.0);
  return polylineOf(points, false);
}

LineNeighbours seenFrom(const std::vector<Polyline>& lines, int own) {
  const LineIndex index(lines);
  return neighboursOf(index, own, tangentsOf(lines[static_cast<std::size_t>(own)], 6), 10.0);
}

TEST(Neighbours, EachPassageOnceInOrderOfOffset) {
  const std::vector<Polyline> lines{along(50.0), along(53.0), along(46.5), along(70.0)};
  const std::vector<Neighbour> seen = seenFrom(lines, 0)[100];
  ASSERT_EQ(seen.size(), 2U);
  EXPECT_EQ(seen[0].line, 2);
  EXPECT_NEAR(seen[0].offset, -3.5, 1e-9);
  EXPECT_EQ(seen[1].line, 1);
  EXPECT_NEAR(seen[1].offset, 3.0, 1e-9);
}

TEST(Neighbours, FarPartsOfTheSameLineCountAndNearOnesDoNot) {
  std::vector<glm::dvec2> hairpin = straightStroke({0.0, 50.0}, {100.0, 50.0});
  const std::vector<glm::dvec2> back = straightStroke({100.0, 54.0}, {0.0, 54.0});
  hairpin.insert(hairpin.end(), back.begin(), back.end());
  const std::vector<Polyline> lines{polylineOf(hairpin, false)};
  const LineNeighbours seen = seenFrom(lines, 0);
  ASSERT_EQ(seen[20].size(), 1U);
  EXPECT_NEAR(seen[20][0].offset, 4.0, 1e-9);
  EXPECT_TRUE(seen[98].empty());
}

TEST(Neighbours, AStrokeOfTwoPointsCountsByItsDirection) {
  const std::vector<Polyline> lines{along(50.0), polylineOf({{100.0, 52.0}, {100.0, 53.0}}, false),
                                    polylineOf({{99.5, 47.0}, {100.5, 47.0}}, false)};
  ASSERT_EQ(lines[1].size(), 2);
  const std::vector<Neighbour> seen = seenFrom(lines, 0)[100];
  ASSERT_EQ(seen.size(), 1U) << "the one across is none";
  EXPECT_EQ(seen[0].line, 2);
}

TEST(Neighbours, SideIsThatOfMostPointsAlongAndACrossingLineIsNoNeighbour) {
  const std::vector<Polyline> crossing_hands{along(50.0, -0.8), along(51.0, 0.8)};
  const LineNeighbours seen = seenFrom(crossing_hands, 0);
  int crossed = 0;
  for (int i = 40; i < 160; ++i)
    for (const Neighbour& neighbour : seen[static_cast<std::size_t>(i)]) {
      crossed += neighbour.offset < 0.0 ? 1 : 0;
      EXPECT_GT(sideOf(crossing_hands[0], seen, i, neighbour), 0.3) << i;
    }
  EXPECT_GT(crossed, 10);

  const std::vector<Polyline> cross{along(50.0),
                                    polylineOf(straightStroke({100.0, 0.0}, {101.0, 100.0}), false)};
  for (const std::vector<Neighbour>& around : seenFrom(cross, 0)) EXPECT_TRUE(around.empty());
}

TEST(Surroundings, FirstJointlyThenKnown) {
  const std::vector<Polyline> lines{along(50.0), along(53.0), along(50.6)};
  const LineNeighbours seen = seenFrom(lines, 0);
  const Surroundings first = surroundingsOf(lines[0], seen, Stage::kFirst, true, {true, true, true})[100];
  EXPECT_EQ(first.own, 0U);
  ASSERT_EQ(first.breaks.size(), 3U);
  EXPECT_NEAR(first.breaks[1], 0.6, 1e-9);
  EXPECT_TRUE(first.range.contains(1e6));

  const Surroundings known = surroundingsOf(lines[0], seen, Stage::kRefine, true, {true, true, true})[100];
  EXPECT_EQ(known.breaks.size(), 1U);
  EXPECT_NEAR(known.range.high, 1.0, 1e-9) << "something is left to either line";

  // A weak line that begins again: the strong neighbour is known, the weak one joint.
  const Surroundings again =
      surroundingsOf(lines[0], seen, Stage::kRestart, false, {false, true, false})[100];
  ASSERT_EQ(again.breaks.size(), 2U);
  EXPECT_NEAR(again.range.high, 3.0 - 0.75, 1e-9);
}

TEST(Surroundings, LinesOnOneEdgeKeepADistanceAtFirstAndThenTakeNothingFromEachOther) {
  const std::vector<Polyline> lines{along(50.0), along(50.1)};
  const LineNeighbours seen = seenFrom(lines, 0);
  EXPECT_NEAR(surroundingsOf(lines[0], seen, Stage::kFirst, true, {true, true})[100].breaks[1], 0.25, 1e-9);
  EXPECT_TRUE(surroundingsOf(lines[0], seen, Stage::kRefine, true, {true, true})[100].range.contains(1e6));
}

TEST(Separate, LinesAlongEachOtherGetTheirOrderBackAndCrossingOnesAreLeft) {
  std::vector<Polyline> lines{along(50.0, -0.8), along(51.0, 0.8)};
  separate(lines);
  for (int i = 20; i < 180; ++i) {
    const double x = i;
    const auto rowAt = [&](const Polyline& line) {
      for (int k = 1; k < line.size(); ++k) {
        const glm::dvec2 a = line.points[static_cast<std::size_t>(k) - 1],
                         b = line.points[static_cast<std::size_t>(k)];
        if (b.x >= x && b.x > a.x) return a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x);
      }
      return 0.0;
    };
    EXPECT_GT(rowAt(lines[1]), rowAt(lines[0])) << i;
  }
  std::vector<Polyline> cross{along(50.0), polylineOf(straightStroke({100.0, 0.0}, {101.0, 100.0}), false)};
  const std::vector<Polyline> before = cross;
  separate(cross);
  EXPECT_EQ(cross[0].points, before[0].points);
  EXPECT_EQ(cross[1].points, before[1].points);
}

}  // namespace
}  // namespace fettle::engine
