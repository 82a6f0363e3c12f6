// Lines at tall walls: where the heights of the samples say on which side they lie, the line runs between them.
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <glm/common.hpp>

#include "engine/base/stopwatch.h"
#include "engine/edges/locate.h"
#include "tests/engine/edges/edge_fields.h"

namespace fettle::engine {
namespace {

constexpr double kWallNoises = 200.0;
// No line that only the four rounds have located states less.
constexpr double kUnsettled = 0.2;

std::vector<EdgeLine> atWalls(const Version& field, const std::vector<EdgeStroke>& strokes) {
  JobControl job;
  auto lines = locateEdgeLines(field.reader(), 1.0, strokes, {}, job);
  EXPECT_TRUE(lines);
  return lines ? *std::move(lines) : std::vector<EdgeLine>{};
}

// A hand that waves across a line.
std::vector<glm::dvec2> wavingStroke(glm::dvec2 from, glm::dvec2 to) {
  std::vector<glm::dvec2> points = straightStroke(from, to);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].y += 1.2 * std::sin(static_cast<double>(i) / 9.0);
  return points;
}

struct Off {
  double rms = 0.0, worst = 0.0, normalised = 0.0, settled = 0.0;
};

// Distances from the truth, `off(position)`, of located points; `counts(position)` picks them.
template <class Distance, class Counts>
Off offOf(const EdgeLine& line, Distance&& off, Counts&& counts) {
  Off sums;
  double n = 0.0;
  for (const EdgePoint& p : line.points) {
    if (!p.located || !counts(p.position)) continue;
    const double d = off(p.position);
    sums.rms += d * d;
    sums.normalised += d * d / (p.deviation * p.deviation);
    sums.worst = std::max(sums.worst, std::abs(d));
    sums.settled += p.deviation < kUnsettled ? 1.0 : 0.0;
    n += 1.0;
  }
  EXPECT_GT(n, 20.0);
  return {std::sqrt(sums.rms / n), sums.worst, std::sqrt(sums.normalised / n), sums.settled / n};
}

constexpr auto kAll = [](glm::dvec2) { return true; };

// A wall slanted by 0.17: not the slope of a low fraction, at which the samples would leave more room.
constexpr double kSlope = 0.17;
double slantedAt(double column) {
  return 30.3 + kSlope * column;
}
double acrossSlanted(glm::dvec2 p) {
  return (p.y - slantedAt(p.x)) / std::hypot(1.0, kSlope);
}
double slantedWall(int c, int r) {
  return (r > slantedAt(c) ? kWallNoises : 0.0) + whiteNoise(c, r);
}
const std::vector<EdgeStroke> kAlongSlanted{
    {0, wavingStroke({10.0, slantedAt(10.0)}, {190.0, slantedAt(190.0)}), false}};

// Samples next to the slanted wall at any height between its sides, and some at that of the wrong one.
double mixedWall(int c, int r) {
  const CounterRandom random(11, 1);
  if (std::abs(r - slantedAt(c)) > 1.0 || random.uniform(c, r) > 0.06) return slantedWall(c, r);
  if (random.uniform(c, r) < 0.02) return (r > slantedAt(c) ? 0.0 : kWallNoises) + whiteNoise(c, r);
  return kWallNoises * random.uniform(r, c);
}

TEST(TallWalls, AStraightWallIsLocatedToATenthOfASample) {
  const Off off = offOf(atWalls(edgeField(200, 100, slantedWall), kAlongSlanted)[0], acrossSlanted, kAll);
  EXPECT_LT(off.rms, 0.06);
  EXPECT_LT(off.worst, 0.16);
  EXPECT_GT(off.settled, 0.95);
  EXPECT_LT(off.normalised, 1.5);
}

TEST(TallWalls, ACurvedWallTooAndUpsideDownTheSame) {
  const auto disc = [](int c, int r) {
    return (std::hypot(c - 64.2, r - 63.7) < 30.0 ? kWallNoises : 0.0) + whiteNoise(c, r);
  };
  std::vector<glm::dvec2> ring;
  for (int i = 0; i < 190; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 190, radius = 30.0 + 1.5 * std::sin(7.0 * angle);
    ring.emplace_back(64.2 + radius * std::cos(angle), 63.7 + radius * std::sin(angle));
  }
  const Version field = edgeField(128, 128, disc);
  const auto lines = atWalls(field, {{0, ring, true}});
  const Off off = offOf(
      lines[0], [](glm::dvec2 p) { return std::hypot(p.x - 64.2, p.y - 63.7) - 30.0; }, kAll);
  EXPECT_LT(off.rms, 0.08);
  EXPECT_LT(off.worst, 0.25);
  EXPECT_GT(off.settled, 0.95);
  const auto down = atWalls(field.inverted(), {{0, ring, true}});
  for (std::size_t i = 0; i < lines[0].points.size(); ++i)
    EXPECT_EQ(lines[0].points[i].position, down[0].points[i].position);
}

TEST(TallWalls, MixedPixelsDoNotMoveTheLine) {
  const Off off = offOf(atWalls(edgeField(200, 100, mixedWall), kAlongSlanted)[0], acrossSlanted, kAll);
  EXPECT_LT(off.rms, 0.065);
  EXPECT_LT(off.worst, 0.3);
  EXPECT_GT(off.settled, 0.9);
}

// Up to a corner the line is as certain as elsewhere; around it, it stays where the rounds had it, and says so.
TEST(TallWalls, ACornerIsNotCut) {
  const auto quadrant = [](int c, int r) {
    const double u = c - 64.3 + 0.3 * (r - 64.1), v = r - 64.1 - 0.3 * (c - 64.3);
    return (u > 0.0 && v > 0.0 ? kWallNoises : 0.0) + whiteNoise(c, r);
  };
  const glm::dvec2 corner{64.3, 64.1}, first{50.0, 15.0}, second{-15.0, 50.0};
  std::vector<glm::dvec2> stroke = wavingStroke(corner + first, corner);
  for (const glm::dvec2 p : wavingStroke(corner, corner + second)) stroke.push_back(p);
  const auto lines = atWalls(edgeField(128, 128, quadrant), {{0, stroke, false}});
  const auto off = [&](glm::dvec2 p) {
    const double u = p.x - 64.3 + 0.3 * (p.y - 64.1), v = p.y - 64.1 - 0.3 * (p.x - 64.3);
    return (std::abs(u) < std::abs(v) ? u : v) / std::hypot(1.0, 0.3);
  };
  const auto clear = [&](glm::dvec2 p) { return std::hypot(p.x - corner.x, p.y - corner.y) > 10.0; };
  const Off walls = offOf(lines[0], off, clear);
  EXPECT_LT(walls.rms, 0.05);
  EXPECT_GT(walls.settled, 0.9);
  for (const EdgePoint& p : lines[0].points) {
    if (!p.located || clear(p.position)) continue;
    EXPECT_LT(std::abs(off(p.position)), 1.5);
    EXPECT_LT(std::abs(off(p.position)), 5.0 * p.deviation) << p.position.x << ", " << p.position.y;
  }
}

TEST(TallWalls, TwoWallsNextToEachOtherKeepTheirs) {
  const auto stairs = [](int c, int r) {
    return (r > slantedAt(c) ? 200.0 : 0.0) + (r > slantedAt(c) + 6.0 ? 120.0 : 0.0) + whiteNoise(c, r);
  };
  std::vector<EdgeStroke> strokes = kAlongSlanted;
  strokes.push_back(strokes[0]);
  for (glm::dvec2& p : strokes[1].points) p.y += 6.5;
  const auto lines = atWalls(edgeField(200, 100, stairs), strokes);
  const Off low = offOf(lines[0], acrossSlanted, kAll);
  const Off high = offOf(
      lines[1], [](glm::dvec2 p) { return acrossSlanted(p - glm::dvec2(0.0, 6.0)); }, kAll);
  for (const Off& off : {low, high}) {
    EXPECT_LT(off.rms, 0.06);
    EXPECT_LT(off.worst, 0.16);
    EXPECT_GT(off.settled, 0.9);
  }
}

// Steps at which heights decide nothing, and noise alone: nothing becomes more certain.
TEST(TallWalls, LowStepsAndNoiseAreLeft) {
  for (const double noises : {0.0, 3.0, 12.0}) {
    const auto low = [&](int c, int r) { return (r > slantedAt(c) ? noises : 0.0) + whiteNoise(c, r); };
    const auto lines = atWalls(edgeField(200, 100, low), kAlongSlanted);
    for (const EdgePoint& p : lines[0].points) EXPECT_TRUE(!p.located || p.deviation >= kUnsettled) << noises;
  }
}

TEST(TallWalls, AHoleNextToTheWallLeavesTheRestWhereItIs) {
  const auto holed = [](int c, int r) {
    const double above = r - slantedAt(c);
    if (c > 90 && c < 105 && above > -1.0 && above < 9.0) return std::numeric_limits<double>::quiet_NaN();
    if (c > 140 && c < 144 && std::abs(above) < 3.0) return std::numeric_limits<double>::infinity();
    return slantedWall(c, r);
  };
  const auto lines = atWalls(edgeField(200, 100, holed), kAlongSlanted);
  const Off off = offOf(lines[0], acrossSlanted, kAll);
  EXPECT_LT(off.rms, 0.3);
  EXPECT_LT(off.worst, 1.5);
  const Off clear = offOf(lines[0], acrossSlanted, [](glm::dvec2 p) { return p.x < 80.0 || p.x > 155.0; });
  EXPECT_LT(clear.rms, 0.1);
}

bool samePoints(const EdgeLine& a, const EdgeLine& b, glm::dvec2 moved = {0.0, 0.0}) {
  if (a.points.size() != b.points.size()) return false;
  for (std::size_t i = 0; i < a.points.size(); ++i)
    if (a.points[i].position + moved != b.points[i].position ||
        a.points[i].deviation != b.points[i].deviation || a.points[i].step != b.points[i].step)
      return false;
  return true;
}

// Positions are counted in samples: neither spacing nor origin of the field changes them, nor how high it lies.
TEST(TallWalls, SpacingOriginAndHeightChangeNothing) {
  // The heights that a float holds at 5e6, so that both fields have the same differences.
  const auto rounded = [](int c, int r) { return std::round(2.0 * mixedWall(c, r)) / 2.0; };
  const EdgeLine plain = atWalls(edgeField(200, 100, rounded), kAlongSlanted)[0];
  Grid grid;
  grid.width = 200;
  grid.height = 100;
  grid.spacing_x = 0.05;
  grid.spacing_y = 0.35;
  grid.origin_x = grid.origin_y = 5e6;
  std::vector<float> heights;
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) heights.push_back(static_cast<float>(rounded(c, r)));
  EXPECT_TRUE(samePoints(plain, atWalls(makeField(grid, heights), kAlongSlanted)[0]));
  const Version high = edgeField(200, 100, [&](int c, int r) { return 5e6 + rounded(c, r); });
  EXPECT_TRUE(samePoints(plain, atWalls(high, kAlongSlanted)[0]));
}

TEST(TallWalls, BitIdenticalForAnyThreadsAndAnyCutThatHoldsTheReach) {
  std::vector<EdgeStroke> strokes = kAlongSlanted;
  for (glm::dvec2& p : strokes[0].points) p = glm::round(p * 0x1p20) * 0x1p-20;
  const EdgeLine all = atWalls(edgeField(200, 100, mixedWall), strokes)[0];
  for (const std::size_t threads : {1U, 3U, 8U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    EXPECT_TRUE(samePoints(all, atWalls(edgeField(200, 100, mixedWall), strokes)[0])) << threads;
  }
  const Version large = edgeField(320, 260, [](int c, int r) { return mixedWall(c - 57, r - 91); });
  const Version cut = edgeField(260, 150, [](int c, int r) { return mixedWall(c - 27, r - 31); });
  for (glm::dvec2& p : strokes[0].points) p += glm::dvec2(57.0, 91.0);
  const EdgeLine in_large = atWalls(large, strokes)[0];
  for (glm::dvec2& p : strokes[0].points) p -= glm::dvec2(30.0, 60.0);
  EXPECT_TRUE(samePoints(in_large, atWalls(cut, strokes)[0], {-30.0, -60.0}));
}

TEST(TallWalls, OneRowOneColumnAndHugeHeights) {
  for (const auto& [width, height] : {std::pair{1, 100}, {200, 1}, {200, 3}})
    for (const double scale : {1.0, 1e30}) {
      const auto lines = atWalls(
          edgeField(width, height, [&](int c, int r) { return scale * mixedWall(c, r); }), kAlongSlanted);
      for (const EdgePoint& p : lines[0].points)
        EXPECT_TRUE(std::isfinite(p.position.x + p.position.y + p.deviation));
    }
}

TEST(TallWalls, SpeedAtAWall) {
  const Version field = edgeField(1200, 260, slantedWall);
  const std::vector<EdgeStroke> strokes{
      {0, wavingStroke({100.0, slantedAt(100.0)}, {1085.0, slantedAt(1085.0)}), false}};
  double fastest = 1e9;
  for (int k = 0; k < 5; ++k) {
    const Stopwatch watch;
    (void)atWalls(field, strokes);
    fastest = std::min(fastest, watch.ms());
  }
  fmt::print("a stroke of 1,000 samples along a wall: {:.0f} ms\n", fastest);
  RecordProperty("milliseconds", fmt::format("{:.1f}", fastest));
}

}  // namespace
}  // namespace fettle::engine
