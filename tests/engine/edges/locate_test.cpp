#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "engine/base/stopwatch.h"
#include "engine/edges/locate.h"
#include "tests/engine/edges/edge_fields.h"
#include "tests/support/no_data.h"

namespace fettle::engine {
namespace {

std::vector<EdgeLine> located(const Version& field, double noise, const std::vector<EdgeStroke>& strokes,
                              const LocateOptions& options = {}) {
  JobControl job;
  auto lines = locateEdgeLines(field.reader(), noise, strokes, options, job);
  EXPECT_TRUE(lines) << (lines ? "" : lines.error().line());
  if (!lines) return {};
  EXPECT_EQ(lines->size(), strokes.size());
  for (const EdgeLine& line : *lines)
    for (const EdgePoint& p : line.points) {
      EXPECT_TRUE(std::isfinite(p.position.x + p.position.y + p.deviation + p.step + p.step_deviation +
                                p.slope_change + p.slope_deviation));
      EXPECT_EQ(p.position.x, std::round(p.position.x * 0x1p20) * 0x1p-20);
    }
  EXPECT_EQ(job.done(), job.total());
  return *std::move(lines);
}

double shareLocated(const EdgeLine& line) {
  double count = 0.0;
  for (const EdgePoint& p : line.points) count += p.located ? 1.0 : 0.0;
  return line.points.empty() ? 0.0 : count / static_cast<double>(line.points.size());
}

// A step of 10 at row 50, noise 1; the hand waves about it.
double stepAt50(int c, int r) {
  return (r >= 50 ? 10.0 : 0.0) + whiteNoise(c, r);
}
std::vector<glm::dvec2> waving(double row, double from = 10.0, double to = 150.0) {
  std::vector<glm::dvec2> points = straightStroke({from, row}, {to, row});
  for (glm::dvec2& p : points) p.y += 1.4 * std::sin(p.x / 9.0);
  return points;
}

TEST(LocateEdgeLines, AWavingHandFindsTheStepWithItsHeightAndDirection) {
  const Version field = edgeField(160, 100, stepAt50);
  const auto lines = located(field, 1.0, {{7, waving(49.5), false}});
  EXPECT_EQ(lines[0].id, 7);
  EXPECT_EQ(shareLocated(lines[0]), 1.0);
  for (const EdgePoint& p : lines[0].points) {
    EXPECT_NEAR(p.position.y, 49.5, 0.6);
    EXPECT_EQ(p.kind, LineKind::kStep);
    // Left of a line along x is up. Four deviations hold for all of 140 dependent points.
    EXPECT_NEAR(p.step, 10.0, 4.0 * p.step_deviation);
    EXPECT_LT(p.step_deviation, 0.6);
    EXPECT_NEAR(p.slope_change, 0.0, 4.0 * p.slope_deviation);
    EXPECT_LT(p.deviation, 0.5);
  }
  EXPECT_NEAR(lines[0].points.front().position.x, 10.0, 1.0);
  EXPECT_NEAR(lines[0].points.back().position.x, 150.0, 1.0);
}

TEST(LocateEdgeLines, InvertedFieldGivesTheSameLineWithTheOtherSign) {
  const Version field = edgeField(160, 100, stepAt50);
  const auto up = located(field, 1.0, {{0, waving(49.5), false}});
  const auto down = located(field.inverted(), 1.0, {{0, waving(49.5), false}});
  for (std::size_t i = 0; i < up[0].points.size(); ++i) {
    EXPECT_EQ(up[0].points[i].position, down[0].points[i].position);
    EXPECT_EQ(up[0].points[i].step, -down[0].points[i].step);
  }
}

TEST(LocateEdgeLines, CreaseIsLocatedAndNamed) {
  const Version field =
      edgeField(160, 100, [](int c, int r) { return 0.8 * std::max(0, r - 50) + 0.5 * whiteNoise(c, r); });
  const auto lines = located(field, 0.5, {{0, waving(50.0), false}});
  EXPECT_EQ(shareLocated(lines[0]), 1.0);
  for (const EdgePoint& p : lines[0].points) {
    EXPECT_NEAR(p.position.y, 50.0, 4.0 * p.deviation);
    EXPECT_EQ(p.kind, LineKind::kCrease);
    EXPECT_NEAR(p.slope_change, 0.8, 4.0 * p.slope_deviation);
  }
}

// Lines a few samples apart, with hands that cross: each line finds its own edge and none crosses.
TEST(LocateEdgeLines, NeighbouringLinesKeepTheirOrder) {
  for (const int apart : {3, 5, 8}) {
    const Version field = edgeField(200, 100, [&](int c, int r) {
      return (r >= 50 ? 6.0 : 0.0) + (r >= 50 + apart ? 6.0 : 0.0) + whiteNoise(c, r);
    });
    std::vector<glm::dvec2> low = waving(49.5, 10.0, 190.0), high = waving(49.5 + apart, 10.0, 190.0);
    for (glm::dvec2& p : high) p.y += 1.4 * std::cos(p.x / 7.0) - 1.4 * std::sin(p.x / 9.0);
    const auto lines = located(field, 1.0, {{0, low, false}, {1, high, false}});
    for (int k = 0; k < 2; ++k) {
      double squares = 0.0;
      for (const EdgePoint& p : lines[static_cast<std::size_t>(k)].points)
        squares += std::pow(p.position.y - 49.5 - k * apart, 2);
      EXPECT_LT(std::sqrt(squares / static_cast<double>(lines[static_cast<std::size_t>(k)].points.size())),
                apart == 3 ? 0.8 : 0.5)
          << apart << " apart, line " << k;
      EXPECT_GT(shareLocated(lines[static_cast<std::size_t>(k)]), apart == 3 ? 0.7 : 0.9) << apart;
    }
    for (const EdgePoint& p : lines[0].points)
      for (const EdgePoint& q : lines[1].points)
        if (std::abs(p.position.x - q.position.x) < 1.0) {
          EXPECT_LT(p.position.y, q.position.y) << apart << " apart at column " << p.position.x;
        }
  }
}

TEST(LocateEdgeLines, NothingToLocateStaysWhereTheHandWas) {
  const Version flat = edgeField(200, 120, [](int c, int r) { return 3.0 + 0.1 * c + whiteNoise(c, r); });
  const std::vector<glm::dvec2> hand = waving(60.0, 10.0, 190.0);
  const auto on_flat = located(flat, 1.0, {{0, hand, false}});
  EXPECT_LT(shareLocated(on_flat[0]), 0.05);
  for (const EdgePoint& p : on_flat[0].points) {
    if (p.located) continue;
    EXPECT_NEAR(p.position.y, 60.0 + 1.4 * std::sin(p.position.x / 9.0), 0.05);
    EXPECT_EQ(p.step, 0.0);
    EXPECT_EQ(p.deviation, 0.0);
  }
  const Version nothing = edgeField(100, 60, [](int, int) { return std::nan(""); });
  EXPECT_EQ(shareLocated(located(nothing, 1.0, {{0, waving(30.0, 5.0, 95.0), false}})[0]), 0.0);
}

TEST(LocateEdgeLines, FlatsAreRarelyMistakenForEdges) {
  double count = 0.0, points = 0.0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Version flat = edgeField(300, 60, [&](int c, int r) { return whiteNoise(c, r, seed); });
    const auto lines = located(flat, 1.0, {{0, waving(30.0, 5.0, 295.0), false}});
    count += shareLocated(lines[0]) * static_cast<double>(lines[0].points.size());
    points += static_cast<double>(lines[0].points.size());
  }
  fmt::print("located on white noise: {:.2f} % of {:.0f} points\n", 100.0 * count / points, points);
  EXPECT_LT(count / points, 0.02);
}

TEST(LocateEdgeLines, AnEdgeThatEndsIsLocatedAsFarAsItGoes) {
  const Version field =
      edgeField(300, 100, [](int c, int r) { return (r >= 50 && c < 150 ? 10.0 : 0.0) + whiteNoise(c, r); });
  const auto lines = located(field, 1.0, {{0, waving(49.5, 10.0, 290.0), false}});
  for (const EdgePoint& p : lines[0].points) {
    if (p.position.x < 140.0) {
      EXPECT_TRUE(p.located) << p.position.x;
    }
    if (p.position.x > 175.0) {
      EXPECT_FALSE(p.located) << p.position.x;
    }
  }
}

TEST(LocateEdgeLines, HolesBordersAndTheOutside) {
  const Version holed = edgeField(160, 100, [](int c, int r) {
    return c > 60 && c < 100 && r > 30 && r < 70 ? std::nan("") : stepAt50(c, r);
  });
  const auto over_hole = located(holed, 1.0, {{0, waving(49.5), false}});
  for (const EdgePoint& p : over_hole[0].points) {
    if (p.position.x > 75.0 && p.position.x < 85.0) {
      EXPECT_FALSE(p.located);
    }
    if (p.position.x < 45.0 || p.position.x > 115.0) {
      EXPECT_TRUE(p.located) << p.position.x;
      EXPECT_NEAR(p.position.y, 49.5, 0.7);
    }
  }
  // An edge two samples from the border has too few samples beyond it for anything but a guess.
  const Version border =
      edgeField(160, 40, [](int c, int r) { return (r < 6 ? 10.0 : 0.0) + whiteNoise(c, r); });
  const auto near_border = located(border, 1.0, {{0, waving(5.5), false}});
  EXPECT_GT(shareLocated(near_border[0]), 0.9);
  for (const EdgePoint& p : near_border[0].points) EXPECT_NEAR(p.position.y, 5.5, 1.5);
  const Version field = edgeField(160, 100, stepAt50);
  EXPECT_EQ(shareLocated(located(field, 1.0, {{0, waving(-2.0), false}})[0]), 0.0);
  EXPECT_EQ(
      shareLocated(located(field, 1.0, {{0, straightStroke({-500.0, 400.0}, {700.0, -4000.0}), false}})[0]),
      0.0);
  const auto leaves = located(field, 1.0, {{0, waving(49.5, -100.0, 300.0), false}});
  for (const EdgePoint& p : leaves[0].points)
    EXPECT_EQ(p.located && (p.position.x < -5.0 || p.position.x > 165.0), false);
}

TEST(LocateEdgeLines, DegenerateStrokes) {
  const Version field = edgeField(160, 100, stepAt50);
  const std::vector<EdgeStroke> strokes{{0, {}, false},
                                        {1, {}, true},
                                        {2, {{50.0, 50.0}}, false},
                                        {3, {{50.0, 50.0}, {50.0, 50.0}}, true},
                                        {4, {{50.0, 50.0}, {52.0, 50.0}}, false}};
  const auto lines = located(field, 1.0, strokes);
  EXPECT_TRUE(lines[0].points.empty());
  EXPECT_TRUE(lines[1].points.empty());
  EXPECT_EQ(lines[2].points.size(), 1U);
  EXPECT_EQ(lines[3].points.size(), 1U);
  EXPECT_EQ(lines[4].points.size(), 3U);
  for (const EdgeLine& line : lines) EXPECT_EQ(shareLocated(line), 0.0);
  EXPECT_EQ(lines[4].points[2].position, glm::dvec2(52.0, 50.0));
  EXPECT_TRUE(located(field, 1.0, {}).empty());
}

TEST(LocateEdgeLines, OneRowOneColumnAndOneSample) {
  const std::vector<glm::dvec2> long_stroke = straightStroke({0.0, 0.0}, {999.0, 0.0});
  const Version row = edgeField(1000, 1, [](int c, int) { return c < 500 ? 0.0 : 10.0; });
  EXPECT_EQ(shareLocated(located(row, 1.0, {{0, long_stroke, false}})[0]), 0.0);
  const Version column = edgeField(1, 1000, [](int, int r) { return r < 500 ? 0.0 : 10.0; });
  EXPECT_EQ(shareLocated(located(column, 1.0, {{0, long_stroke, false}})[0]), 0.0);
  const Version sample = edgeField(1, 1, [](int, int) { return 1.0; });
  EXPECT_EQ(shareLocated(located(sample, 1.0, {{0, long_stroke, false}})[0]), 0.0);
}

TEST(LocateEdgeLines, SpikesDoNotMoveTheLine) {
  const Version spiked = edgeField(160, 100, [](int c, int r) {
    const CounterRandom random(3, 1);
    return random.uniform(c, r) < 0.02 ? 1e6 * (random.uniform(r, c) - 0.5) : stepAt50(c, r);
  });
  const auto lines = located(spiked, 1.0, {{0, waving(49.5), false}});
  EXPECT_GT(shareLocated(lines[0]), 0.95);
  for (const EdgePoint& p : lines[0].points) EXPECT_NEAR(p.position.y, 49.5, 0.8);
}

TEST(LocateEdgeLines, HeightsOfFiveMillionLoseNothing) {
  // The heights that a float holds there, so that both fields have the same differences.
  const auto rounded = [](int c, int r) { return std::round(2.0 * stepAt50(c, r)) / 2.0; };
  const Version low = edgeField(160, 100, rounded);
  const Version high = edgeField(160, 100, [&](int c, int r) { return 5e6 + rounded(c, r); });
  const auto below = located(low, 1.0, {{0, waving(49.5), false}});
  const auto above = located(high, 1.0, {{0, waving(49.5), false}});
  ASSERT_EQ(below[0].points.size(), above[0].points.size());
  for (std::size_t i = 0; i < below[0].points.size(); ++i) {
    EXPECT_EQ(below[0].points[i].position, above[0].points[i].position);
    EXPECT_EQ(below[0].points[i].step, above[0].points[i].step);
  }
}

TEST(LocateEdgeLines, ClosedCircleHasNoSeamAndASelfCrossingIsLocatedOnItsEdges) {
  const Version disc = edgeField(128, 128, [](int c, int r) {
    return (std::hypot(c - 64.0, r - 64.0) < 40.0 ? 10.0 : 0.0) + whiteNoise(c, r);
  });
  std::vector<glm::dvec2> ring;
  for (int i = 0; i < 250; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 250, radius = 40.0 + 1.5 * std::sin(9.0 * angle);
    ring.emplace_back(64.0 + radius * std::cos(angle), 64.0 + radius * std::sin(angle));
  }
  const auto lines = located(disc, 1.0, {{0, ring, true}});
  EXPECT_TRUE(lines[0].closed);
  EXPECT_EQ(shareLocated(lines[0]), 1.0);
  for (const EdgePoint& p : lines[0].points)
    EXPECT_NEAR(std::hypot(p.position.x - 64.0, p.position.y - 64.0), 39.75, 0.8);
  const glm::dvec2 seam = lines[0].points.back().position - lines[0].points.front().position;
  EXPECT_LT(std::hypot(seam.x, seam.y), 2.0);
  EXPECT_GT(lines[0].points[0].step, 0.0) << "counter-clockwise: inside is left";

  // A figure of eight over four quadrants of a chessboard.
  const Version board = edgeField(
      128, 128, [](int c, int r) { return ((c < 64) == (r < 64) ? 10.0 : 0.0) + whiteNoise(c, r); });
  std::vector<glm::dvec2> crossing = straightStroke({63.5, 10.0}, {63.5, 110.0});
  for (const glm::dvec2 p : straightStroke({110.0, 110.0}, {110.0, 63.5})) crossing.push_back(p);
  for (const glm::dvec2 p : straightStroke({109.0, 63.5}, {10.0, 63.5})) crossing.push_back(p);
  const auto eight = located(board, 1.0, {{0, crossing, false}});
  for (const EdgePoint& p : eight[0].points)
    if (p.located && p.position.y > 14.0 && p.position.y < 50.0) {
      EXPECT_NEAR(p.position.x, 63.5, 0.7);
    }
}

TEST(LocateEdgeLines, TwoStrokesOverEachOtherFindTheSameEdge) {
  const Version field = edgeField(160, 100, stepAt50);
  const auto lines = located(field, 1.0, {{0, waving(49.5), false}, {1, waving(50.0), false}});
  // Only one of them can have it; the other stays within the reach of its hand.
  double least = 1e9;
  for (const EdgeLine& line : lines) {
    double squares = 0.0;
    for (const EdgePoint& p : line.points) {
      squares += std::pow(p.position.y - 49.5, 2);
      EXPECT_LT(std::abs(p.position.y - 49.5), 6.0);
    }
    least = std::min(least, std::sqrt(squares / static_cast<double>(line.points.size())));
  }
  EXPECT_LT(least, 0.9);
}

bool same(const std::vector<EdgeLine>& a, const std::vector<EdgeLine>& b, glm::dvec2 moved = {0.0, 0.0}) {
  if (a.size() != b.size()) return false;
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (a[k].points.size() != b[k].points.size()) return false;
    for (std::size_t i = 0; i < a[k].points.size(); ++i) {
      const EdgePoint &p = a[k].points[i], &q = b[k].points[i];
      if (p.position + moved != q.position || p.located != q.located || p.kind != q.kind ||
          p.deviation != q.deviation || p.step != q.step || p.step_deviation != q.step_deviation ||
          p.slope_change != q.slope_change || p.slope_deviation != q.slope_deviation)
        return false;
    }
  }
  return true;
}

// A field with edges of several kinds, and strokes whose coordinates are multiples of 2^-20.
double cornered(int c, int r) {
  return (r + 0.2 * c >= 60.0 ? 8.0 : 0.0) + (r + 0.2 * c >= 66.0 ? 4.0 : 0.0) + 0.3 * std::max(0, c - 110) +
         whiteNoise(c, r);
}
std::vector<EdgeStroke> corneredStrokes(glm::dvec2 moved) {
  std::vector<EdgeStroke> strokes{{0, straightStroke({40.0, 51.0}, {160.0, 29.0}), false},
                                  {1, straightStroke({40.0, 59.0}, {160.0, 33.0}), false},
                                  {2, straightStroke({110.5, 80.0}, {109.5, 40.0}), false}};
  for (EdgeStroke& stroke : strokes)
    for (glm::dvec2& p : stroke.points)
      p = {std::round(p.x * 0x1p20) * 0x1p-20 + moved.x, std::round(p.y * 0x1p20) * 0x1p-20 + moved.y};
  return strokes;
}

TEST(LocateEdgeLines, BitIdenticalForAnyNumberOfThreads) {
  const Version field = edgeField(200, 120, cornered);
  const auto all = located(field, 1.0, corneredStrokes({0.0, 0.0}));
  for (const std::size_t threads : {1U, 3U, 8U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    EXPECT_TRUE(same(all, located(field, 1.0, corneredStrokes({0.0, 0.0})))) << threads;
  }
  EXPECT_GT(shareLocated(all[0]), 0.9);
}

TEST(LocateEdgeLines, BitIdenticalForAnyCutThatHoldsTheReach) {
  const int reach = locateReach({});
  // The strokes lie within columns 40 .. 160 and rows 29 .. 80.
  const Version large = edgeField(300, 200, [](int c, int r) { return cornered(c - 57, r - 33); });
  const Version cut = edgeField(121 + 2 * reach, 52 + 2 * reach,
                                [&](int c, int r) { return cornered(c + 40 - reach, r + 29 - reach); });
  const auto in_large = located(large, 1.0, corneredStrokes({57.0, 33.0}));
  const auto in_cut = located(cut, 1.0, corneredStrokes({reach - 40.0, reach - 29.0}));
  EXPECT_TRUE(same(in_large, in_cut, {reach - 40.0 - 57.0, reach - 29.0 - 33.0}));
}

TEST(LocateEdgeLines, TimeGoesWithTheStrokeAndNotWithTheField) {
  const Version large = edgeField(262144, 40, [](int, int r) { return r >= 20 ? 10.0 : 0.0; });
  const Stopwatch watch;
  const auto lines = located(large, 1.0, {{0, straightStroke({131000.0, 19.0}, {131060.0, 20.0}), false}});
  const double seconds = watch.seconds();
  fmt::print("a stroke of 60 samples in a field of {} samples: {:.1f} ms\n", large.grid().samples(),
             1e3 * seconds);
  EXPECT_GT(shareLocated(lines[0]), 0.9);
  EXPECT_LT(seconds, 5.0);  // to read all of the field once takes longer under a sanitizer
}

TEST(LocateEdgeLines, Speed) {
  const Version field = edgeField(1200, 100, stepAt50);
  const std::vector<EdgeStroke> strokes{{0, waving(49.5, 100.0, 1100.0), false}};
  double fastest = 1e9;
  for (int k = 0; k < 5; ++k) {
    const Stopwatch watch;
    (void)located(field, 1.0, strokes);
    fastest = std::min(fastest, watch.ms());
  }
  fmt::print("a stroke of 1,000 samples: {:.0f} ms\n", fastest);
  RecordProperty("milliseconds", fmt::format("{:.1f}", fastest));
}

TEST(LocateEdgeLines, RefusesWhatMakesNoSense) {
  const Version field = edgeField(20, 20, [](int, int) { return 1.0; });
  JobControl job;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](double noise, const EdgeStroke& stroke, double hand = 1.2) {
    const auto lines = locateEdgeLines(field.reader(), noise, {&stroke, 1}, {hand}, job);
    return !lines && lines.error().kind == ErrorKind::kInput;
  };
  const EdgeStroke fine{0, {{1.0, 1.0}, {9.0, 9.0}}, false};
  EXPECT_FALSE(refused(1.0, fine));
  for (const double noise : {0.0, -1.0, nan, 1.0 / 0.0}) EXPECT_TRUE(refused(noise, fine)) << noise;
  for (const double hand : {0.1, 3.5, nan}) EXPECT_TRUE(refused(1.0, fine, hand)) << hand;
  EXPECT_TRUE(refused(1.0, {0, {{nan, 1.0}}, false}));
  EXPECT_TRUE(refused(1.0, {0, {{1.0, 1e300}}, false}));
  EdgeStroke endless;
  for (int i = 0; i < 100; ++i) endless.points.emplace_back(i % 2 == 0 ? -1e6 : 1e6, 0.0);
  EXPECT_TRUE(refused(1.0, endless));
}

TEST(LocateEdgeLines, CanBeCancelled) {
  const Version field = edgeField(160, 100, stepAt50);
  const EdgeStroke stroke{0, waving(49.5), false};
  JobControl job;
  job.cancel();
  const auto lines = locateEdgeLines(field.reader(), 1.0, {&stroke, 1}, {}, job);
  ASSERT_FALSE(lines);
  EXPECT_EQ(lines.error().kind, ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::engine
