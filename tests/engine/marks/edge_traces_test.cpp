#include "engine/marks/edge_traces.h"

#include <cmath>
#include <set>
#include <utility>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

namespace fettle::engine {
namespace {

// A map whose candidates are the rounded points of curves.
struct Drawing {
  EdgeMap map;
  Grid grid;
  std::set<std::pair<int, int>> samples;

  Drawing() {
    map.sigma = 1.5;
    grid.width = grid.height = 200;
  }
  void add(double x, double y) {
    const auto column = static_cast<std::int32_t>(std::lround(x)),
               row = static_cast<std::int32_t>(std::lround(y));
    if (samples.emplace(row, column).second) map.candidates.push_back({column, row, 100.0F});
  }
  void line(glm::dvec2 from, glm::dvec2 to) {
    const int pieces = static_cast<int>(2.0 * glm::distance(from, to));
    for (int i = 0; i <= pieces; ++i) {
      const glm::dvec2 at = from + (to - from) * (static_cast<double>(i) / pieces);
      add(at.x, at.y);
    }
  }
  [[nodiscard]] std::vector<EdgeTrace> traced() const {
    JobControl job;
    const auto traces = traceEdges(grid, map, {}, job);
    EXPECT_TRUE(traces);
    return traces.value_or(std::vector<EdgeTrace>());
  }
};

double lengthOf(const EdgeTrace& trace) {
  double length = 0.0;
  for (std::size_t i = 1; i < trace.points.size(); ++i)
    length += glm::distance(trace.points[i - 1], trace.points[i]);
  return length;
}

void expectConnected(const EdgeTrace& trace) {
  for (std::size_t i = 1; i < trace.points.size(); ++i) {
    const glm::dvec2 d = glm::abs(trace.points[i] - trace.points[i - 1]);
    EXPECT_LE(std::max(d.x, d.y), 4.0);
  }
}

TEST(EdgeTraces, ALineIsOneTraceFromEndToEnd) {
  Drawing drawing;
  drawing.line({20, 30}, {150, 71});
  const auto traces = drawing.traced();
  ASSERT_EQ(traces.size(), 1U);
  EXPECT_FALSE(traces[0].closed);
  EXPECT_NEAR(glm::distance(traces[0].points.front(), traces[0].points.back()), 136.3, 1.5);
  expectConnected(traces[0]);
}

TEST(EdgeTraces, ACircleIsOneClosedTrace) {
  Drawing drawing;
  for (int i = 0; i < 2000; ++i) {
    const double angle = 2.0 * 3.14159265358979 * i / 2000.0;
    drawing.add(100.0 + 50.0 * std::cos(angle), 90.0 + 50.0 * std::sin(angle));
  }
  const auto traces = drawing.traced();
  ASSERT_EQ(traces.size(), 1U);
  EXPECT_TRUE(traces[0].closed);
  EXPECT_NEAR(lengthOf(traces[0]), 2.0 * 3.1416 * 50.0, 35.0);
  expectConnected(traces[0]);
}

TEST(EdgeTraces, AStemEndsAtTheBarItMeets) {
  Drawing drawing;
  drawing.line({20, 100}, {180, 100});
  drawing.line({100, 100}, {100, 160});
  const auto traces = drawing.traced();
  ASSERT_EQ(traces.size(), 2U);
  EXPECT_NEAR(lengthOf(traces[0]) + lengthOf(traces[1]), 220.0, 6.0);
  for (const EdgeTrace& trace : traces) expectConnected(trace);
}

TEST(EdgeTraces, LinesThatCrossGoOnStraight) {
  Drawing drawing;
  drawing.line({20, 20}, {180, 180});
  drawing.line({80, 130}, {120, 70});
  const auto traces = drawing.traced();
  ASSERT_EQ(traces.size(), 2U);
  EXPECT_NEAR(glm::distance(traces[0].points.front(), traces[0].points.back()), 226.3, 3.0);
  EXPECT_NEAR(glm::distance(traces[1].points.front(), traces[1].points.back()), 72.1, 3.0);
  for (const EdgeTrace& trace : traces) EXPECT_LE(glm::distance(trace.points[1], trace.points[0]), 8.0);
}

TEST(EdgeTraces, NothingAndLittleAreNoTraces) {
  Drawing drawing;
  EXPECT_TRUE(drawing.traced().empty());
  drawing.add(5, 5);
  drawing.add(6, 5);
  EXPECT_TRUE(drawing.traced().empty());
  JobControl job;
  EdgeChoice choice;
  choice.sensitivity = 2.0;
  EXPECT_FALSE(traceEdges(drawing.grid, drawing.map, choice, job));
  job.cancel();
  EXPECT_FALSE(traceEdges(drawing.grid, drawing.map, {}, job));
}

}  // namespace
}  // namespace fettle::engine
