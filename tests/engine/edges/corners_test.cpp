#include "engine/edges/corners.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "tests/engine/filter/edge_line_of.h"

namespace fettle::engine {
namespace {

// Figures differ from point to point, as those of located ones.
EdgeLine cornerLine(const std::vector<glm::dvec2>& corners, double deviation = 0.0) {
  EdgeLine line = tests::edgeLineOf(corners, deviation);
  for (std::size_t i = 0; i < line.points.size(); ++i)
    line.points[i].step = 0.1 + 1e-4 * static_cast<double>(i);
  return line;
}

glm::dvec2 frontOf(const EdgeLine& line) {
  return line.points.front().position;
}
glm::dvec2 backOf(const EdgeLine& line) {
  return line.points.back().position;
}

TEST(Corners, TwoEndsMeetWhereTheirDirectionsDo) {
  std::vector<EdgeLine> lines{cornerLine({{10.0, 20.0}, {37.5, 20.0}}, 0.3),
                              cornerLine({{40.0, 50.0}, {40.0, 22.0}}, 0.3)};
  lines[0].points.back().step = 0.7;
  const std::size_t before = lines[0].points.size();
  extendEnds(lines, 0, 100, 100);
  EXPECT_EQ(backOf(lines[0]), glm::dvec2(40.0, 20.0));
  EXPECT_EQ(backOf(lines[1]), glm::dvec2(40.0, 20.0));
  ASSERT_GT(lines[0].points.size(), before);
  EXPECT_EQ(frontOf(lines[0]), glm::dvec2(10.0, 20.0));
  const EdgePoint& corner = lines[0].points.back();
  EXPECT_TRUE(corner.located);
  EXPECT_EQ(corner.step, 0.7);
  EXPECT_GT(corner.deviation, 0.3);
  EXPECT_LT(corner.deviation, 0.6);
  EXPECT_EQ(withoutExtensions(lines[0]).points.size(), before);
  // Once is enough.
  const std::vector<EdgeLine> met = lines;
  extendEnds(lines, 0, 100, 100);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(lines[k].points.size(), met[k].points.size());
}

TEST(Corners, EndsThatMeetAlreadyStayAsTheyAre) {
  const std::vector<EdgeLine> before{
      cornerLine({{10.0, 20.0}, {39.98, 20.0}}), cornerLine({{40.0, 50.0}, {40.0, 20.02}}),
      cornerLine({{60.0, 20.0}, {40.05, 20.0}}),
      // Its own two ends, around a corner.
      cornerLine({{70.1, 70.0}, {90.0, 70.0}, {90.0, 90.0}, {70.0, 90.0}, {70.0, 70.1}})};
  std::vector<EdgeLine> lines = before;
  extendEnds(lines, 0, 100, 100);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    EXPECT_EQ(backOf(lines[k]), backOf(before[k])) << k;
    if (k == 3) {
      EXPECT_EQ(frontOf(lines[k]), frontOf(before[k]));
    }
    EXPECT_EQ(lines[k].points.size(), before[k].points.size()) << k;
  }
}

TEST(Corners, AnEndMeetsALineAndTheBorder) {
  std::vector<EdgeLine> lines{cornerLine({{2.0, 30.25}, {97.5, 30.25}}),
                              cornerLine({{50.0, 60.0}, {50.0, 33.0}}),
                              cornerLine({{70.0, 60.0}, {70.0, 35.0}})};
  extendEnds(lines, 0, 100, 100);
  EXPECT_EQ(frontOf(lines[0]), glm::dvec2(0.0, 30.25));
  EXPECT_EQ(backOf(lines[0]), glm::dvec2(99.0, 30.25));
  EXPECT_EQ(backOf(lines[1]), glm::dvec2(50.0, 30.25));
  EXPECT_EQ(backOf(lines[2]), glm::dvec2(70.0, 35.0));  // too far
  for (const EdgeLine& line : lines)
    for (std::size_t i = 1; i < line.points.size(); ++i)
      EXPECT_LE(glm::distance(line.points[i - 1].position, line.points[i].position), EdgeLine::kMostApart);
}

TEST(Corners, WhatRunsAlongOrIsNotLocatedMeetsNothing) {
  // Almost parallel; a plain mark in the way; a closed line.
  std::vector<EdgeLine> lines{
      cornerLine({{10.0, 20.0}, {40.0, 20.0}}), cornerLine({{41.0, 20.2}, {80.0, 24.0}}),
      cornerLine({{10.0, 60.0}, {40.0, 60.0}}), cornerLine({{42.0, 50.0}, {42.0, 70.0}})};
  for (EdgePoint& point : lines[3].points) point.located = false;
  lines.push_back(cornerLine({{60.0, 60.0}, {70.0, 60.0}, {65.0, 70.0}, {60.0, 60.5}}));
  lines.back().closed = true;
  lines.push_back({});
  const std::vector<EdgeLine> before = lines;
  extendEnds(lines, 0, 100, 100);
  for (std::size_t k = 0; k < lines.size(); ++k)
    EXPECT_EQ(lines[k].points.size(), before[k].points.size()) << k;
}

TEST(Corners, LinesBeforeTheFirstAreExtendedToLaterOnesOnly) {
  std::vector<EdgeLine> lines{
      cornerLine({{2.0, 20.0}, {37.5, 20.0}}), cornerLine({{30.0, 80.0}, {60.0, 80.0}}),
      cornerLine({{63.0, 70.0}, {63.0, 78.0}}), cornerLine({{40.0, 50.0}, {40.0, 22.0}})};
  extendEnds(lines, 3, 100, 100);
  EXPECT_EQ(frontOf(lines[0]), glm::dvec2(2.0, 20.0));  // the border was there before
  EXPECT_EQ(backOf(lines[0]), glm::dvec2(40.0, 20.0));
  EXPECT_EQ(backOf(lines[1]), glm::dvec2(60.0, 80.0));
  EXPECT_EQ(backOf(lines[2]), glm::dvec2(63.0, 78.0));
  EXPECT_EQ(backOf(lines[3]), glm::dvec2(40.0, 20.0));
}

TEST(Corners, FieldsOfOneRowAndLinesOutsideAreLeft) {
  std::vector<EdgeLine> lines{cornerLine({{-30.0, -5.0}, {-12.0, -5.0}}),
                              cornerLine({{1.0, 0.0}, {8.0, 0.0}}), cornerLine({{3.0, 0.0}, {3.0, 0.0}})};
  extendEnds(lines, 0, 10, 1);
  EXPECT_EQ(backOf(lines[0]), glm::dvec2(-12.0, -5.0));
  EXPECT_EQ(backOf(lines[1]), glm::dvec2(9.0, 0.0));
  for (const EdgeLine& line : lines)
    for (const EdgePoint& point : line.points)
      EXPECT_TRUE(std::isfinite(point.position.x) && std::isfinite(point.position.y));
}

}  // namespace
}  // namespace fettle::engine
