#include "engine/edges/corners.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "tests/engine/filter/edge_line_of.h"

namespace fettle::engine {
namespace {

using tests::edgeLineOf;

glm::dvec2 frontOf(const EdgeLine& line) {
  return line.points.front().position;
}
glm::dvec2 backOf(const EdgeLine& line) {
  return line.points.back().position;
}

TEST(Corners, TwoEndsMeetWhereTheirDirectionsDo) {
  std::vector<EdgeLine> lines{edgeLineOf({{10.0, 20.0}, {37.5, 20.0}}, 0.3),
                              edgeLineOf({{40.0, 50.0}, {40.0, 22.0}}, 0.3)};
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
  // Once is enough.
  const std::vector<EdgeLine> met = lines;
  extendEnds(lines, 0, 100, 100);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(lines[k].points.size(), met[k].points.size());
}

TEST(Corners, AnEndMeetsALineAndTheBorder) {
  std::vector<EdgeLine> lines{edgeLineOf({{2.0, 30.25}, {97.5, 30.25}}),
                              edgeLineOf({{50.0, 60.0}, {50.0, 33.0}}),
                              edgeLineOf({{70.0, 60.0}, {70.0, 35.0}})};
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
      edgeLineOf({{10.0, 20.0}, {40.0, 20.0}}), edgeLineOf({{41.0, 20.2}, {80.0, 24.0}}),
      edgeLineOf({{10.0, 60.0}, {40.0, 60.0}}), edgeLineOf({{42.0, 50.0}, {42.0, 70.0}})};
  for (EdgePoint& point : lines[3].points) point.located = false;
  lines.push_back(edgeLineOf({{60.0, 60.0}, {70.0, 60.0}, {65.0, 70.0}, {60.0, 60.5}}));
  lines.back().closed = true;
  lines.push_back({});
  const std::vector<EdgeLine> before = lines;
  extendEnds(lines, 0, 100, 100);
  for (std::size_t k = 0; k < lines.size(); ++k)
    EXPECT_EQ(lines[k].points.size(), before[k].points.size()) << k;
}

TEST(Corners, LinesBeforeTheFirstStayAsTheyAre) {
  std::vector<EdgeLine> lines{edgeLineOf({{10.0, 20.0}, {37.5, 20.0}}),
                              edgeLineOf({{40.0, 50.0}, {40.0, 22.0}})};
  extendEnds(lines, 1, 100, 100);
  EXPECT_EQ(backOf(lines[0]), glm::dvec2(37.5, 20.0));
  EXPECT_EQ(backOf(lines[1]), glm::dvec2(40.0, 20.0));
}

TEST(Corners, FieldsOfOneRowAndLinesOutsideAreLeft) {
  std::vector<EdgeLine> lines{edgeLineOf({{-30.0, -5.0}, {-12.0, -5.0}}),
                              edgeLineOf({{1.0, 0.0}, {8.0, 0.0}}), edgeLineOf({{3.0, 0.0}, {3.0, 0.0}})};
  extendEnds(lines, 0, 10, 1);
  EXPECT_EQ(backOf(lines[0]), glm::dvec2(-12.0, -5.0));
  EXPECT_EQ(backOf(lines[1]), glm::dvec2(9.0, 0.0));
  for (const EdgeLine& line : lines)
    for (const EdgePoint& point : line.points)
      EXPECT_TRUE(std::isfinite(point.position.x) && std::isfinite(point.position.y));
}

}  // namespace
}  // namespace fettle::engine
