#include "haptic/operator/operator_strokes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "haptic/operator/hand_drift.h"
#include "haptic/operator/hand_motion.h"
#include "haptic/scene/scene.h"
#include "haptic/tick/replay.h"
#include "tests/support/no_data.h"

namespace fettle::haptic {
namespace {

using engine::Edge;
using engine::EdgeKind;

// 40 x 30 mm at 0.1 mm: a plane at 2 mm + 0.1 x, with a hole in the middle when asked for.
engine::Version plane(bool holed = false) {
  engine::Grid grid;
  grid.width = 401;
  grid.height = 301;
  grid.spacing_x = grid.spacing_y = 0.1;
  std::vector<float> z;
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c)
      z.push_back(holed && c > 150 && c < 250 ? kNan : 2.0F + 0.01F * static_cast<float>(c));
  return engine::makeField(grid, z);
}

Edge straight(glm::dvec2 from, glm::dvec2 to) {
  Edge edge;
  for (int i = 0; i <= 100; ++i) {
    edge.points_mm.push_back(from + (to - from) * (i / 100.0));
    edge.strength.push_back(1.0);
  }
  return edge;
}

Edge ring(glm::dvec2 centre, double radius) {
  Edge edge;
  edge.closed = true;
  for (int i = 0; i < 400; ++i) {
    const double t = 2.0 * 3.14159265358979323846 * i / 400;
    edge.points_mm.push_back(centre + radius * glm::dvec2{std::cos(t), std::sin(t)});
    edge.strength.push_back(1.0);
  }
  return edge;
}

double away(const Edge& edge, glm::dvec2 p) {
  double nearest = std::numeric_limits<double>::infinity();
  const std::size_t n = edge.points_mm.size();
  for (std::size_t i = 0; i + (edge.closed ? 0 : 1) < n; ++i) {
    const glm::dvec2 a = edge.points_mm[i];
    const glm::dvec2 way = edge.points_mm[(i + 1) % n] - a;
    const glm::dvec2 to = p - a;
    const double t = std::clamp((to.x * way.x + to.y * way.y) / (way.x * way.x + way.y * way.y), 0.0, 1.0);
    const glm::dvec2 off = to - way * t;
    nearest = std::min(nearest, std::hypot(off.x, off.y));
  }
  return nearest;
}

std::vector<StrokeSample> stroked(const std::vector<Edge>& edges, const OperatorSpec& spec,
                                  bool holed = false) {
  return operatorStrokes(plane(holed), edges, spec);
}

OperatorSpec steady() {
  OperatorSpec spec;
  spec.tremor_mm = 0.0;
  spec.wander_mm = 0.0;
  return spec;
}

TEST(OperatorStrokes, RowsAreAMillisecondApartFromZeroOn) {
  const auto rows = stroked({straight({5, 5}, {30, 20}), ring({20, 15}, 6)}, {});
  ASSERT_GT(rows.size(), 1000U);
  for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_DOUBLE_EQ(rows[i].t, static_cast<double>(i) / 1000.0);
}

TEST(OperatorStrokes, MarkRowsStayWithinTheHandsBoundOfTheEdgeAndAreNotOnIt) {
  const Edge edge = ring({20, 15}, 6);
  OperatorSpec spec;
  spec.tremor_mm = 0.05;
  spec.wander_mm = 0.1;
  double farthest = 0.0;
  double square = 0.0;
  double marks = 0.0;
  for (const StrokeSample& row : stroked({edge}, spec)) {
    if (row.tool != Tool::kMark) continue;
    const double d = away(edge, {row.tip_mm.x, row.tip_mm.y});
    farthest = std::max(farthest, d);
    square += d * d;
    marks += 1.0;
  }
  // Both axes at their bound at once.
  EXPECT_LE(farthest, HandMotion::kBound * (0.05 + 0.1) * std::sqrt(2.0));
  // Across the edge the hand's variance is tremor^2 + wander^2 = 0.0125 in the mean over hands; one stroke of
  // two seconds holds two periods of the slow wander at least, so within a factor of four.
  EXPECT_GT(square / marks, 0.0125 / 4.0);
  EXPECT_LT(square / marks, 0.0125 * 4.0);
  EXPECT_NEAR(marks, (2.0 * 3.14159265 * 6.0 + 1.0) / 20.0 * 1000.0, 20.0);
}

TEST(OperatorStrokes, ASteadyHandIsOnTheEdgeAtThePressDepth) {
  const Edge edge = straight({5, 5}, {30, 20});
  OperatorSpec spec = steady();
  spec.press_mm = 0.25;
  double first = std::numeric_limits<double>::infinity();
  double last = -first;
  for (const StrokeSample& row : stroked({edge}, spec)) {
    if (row.tool != Tool::kMark) continue;
    EXPECT_LT(away(edge, {row.tip_mm.x, row.tip_mm.y}), 1e-12);
    // Bilinear on a plane is the plane: heights are floats of about 4, half an ulp is 2.4e-7.
    EXPECT_NEAR(row.tip_mm.z, 2.0 + 0.1 * row.tip_mm.x - 0.25, 1e-6);
    first = std::min(first, row.tip_mm.x);
    last = std::max(last, row.tip_mm.x);
  }
  EXPECT_LT(first, 5.0 + 0.05);
  EXPECT_EQ(last, 30.0);
}

// In height, too: away from the surface where the hand's own motion is.
TEST(OperatorStrokes, ATremblingHandLeavesTheLineAsItsDriftSays) {
  const glm::dvec2 from{5, 5}, to{30, 20};
  OperatorSpec spec;
  spec.smooth_passes = 0;
  spec.seed = 12;
  const HandDrift drift(spec.wander_mm, spec.tremor_mm, spec.seed, 1);
  const double length = std::hypot(to.x - from.x, to.y - from.y);
  double i = 0.0;
  for (const StrokeSample& row : stroked({straight(from, to)}, spec)) {
    if (row.tool != Tool::kMark) continue;
    i += 1.0;
    const double seconds = i / spec.rate_hz;
    const glm::dvec2 p =
        from + (to - from) * std::min(1.0, spec.speed_mm_s * seconds / length) + drift.at(seconds);
    EXPECT_NEAR(row.tip_mm.x, p.x, 1e-9);
    EXPECT_NEAR(row.tip_mm.y, p.y, 1e-9);
    EXPECT_NEAR(row.tip_mm.z, 2.0 + 0.1 * p.x - spec.press_mm + drift.heightAt(seconds), 1e-6);
  }
  EXPECT_GT(i, 1000.0);
}

TEST(OperatorStrokes, MarkingAStepTheTipStaysAtItsFootAndComesDownOnTheLowSide) {
  engine::Grid grid;
  grid.width = grid.height = 201;
  grid.spacing_x = grid.spacing_y = 0.1;
  std::vector<float> z;
  for (int r = 0; r < 201; ++r)
    for (int c = 0; c < 201; ++c) z.push_back(r > 100 ? 7.0F : 1.0F);
  const engine::Version step = engine::makeField(grid, z);
  const std::vector<Edge> edges{straight({3, 10.05}, {17, 10.05})};  // the high side is on the left
  OperatorSpec spec;
  spec.guide_mm = 0.5;
  spec.smooth_passes = 0;
  spec.tremor_mm = 0.02;
  spec.wander_mm = 0.05;  // never 0.28 mm off, so the foot is within reach of the guide
  bool above_low_land = false;
  for (const StrokeSample& row : operatorStrokes(step, edges, spec)) {
    if (row.tool == Tool::kMark) {
      EXPECT_NEAR(row.tip_mm.z, 1.0 - spec.press_mm, HandMotion::kBound * 0.5 * spec.tremor_mm + 1e-6);
      EXPECT_TRUE(above_low_land);
    } else if (row.tip_mm.z < 7.0 && row.tip_mm.z > 1.2) {
      above_low_land = above_low_land || row.tip_mm.y < 10.0;
    }
  }
}

TEST(OperatorStrokes, SmoothPassesRunBesideTheEdgeOnItsHighSide) {
  for (const bool left : {true, false}) {
    Edge edge = straight({5, 10}, {30, 10});
    edge.high_side_left = left;
    OperatorSpec spec = steady();
    spec.smooth_offset_mm = 0.6;
    int smooth = 0;
    for (const StrokeSample& row : stroked({edge}, spec))
      if (row.tool == Tool::kSmooth) {
        ++smooth;
        EXPECT_NEAR(row.tip_mm.y, left ? 10.6 : 9.4, 1e-12);
      }
    EXPECT_GT(smooth, 1000);
  }
}

TEST(OperatorStrokes, SmoothPassesOnlyFeelWhereAnotherEdgeIsNear) {
  Edge edge = straight({5, 10}, {30, 10});
  const Edge other = straight({15, 10.8}, {20, 10.8});
  OperatorSpec spec = steady();
  spec.smooth_offset_mm = 0.5;
  spec.smooth_clear_mm = 0.45;
  int felt = 0;
  for (const StrokeSample& row : stroked({edge, other}, spec)) {
    const glm::dvec2 p{row.tip_mm.x, row.tip_mm.y};
    // Neighbouring points of the lines lie 0.25 and 0.05 mm apart, so the nearest point is hardly farther
    // off.
    if (row.tool == Tool::kSmooth) {
      EXPECT_GT(std::min(away(edge, p), away(other, p)), 0.45 - 0.04);
    }
    felt += row.tool == Tool::kFeel && std::abs(p.y - 10.5) < 1e-9 && p.x > 15 && p.x < 20;
  }
  EXPECT_GT(felt, 200);
}

// A rough land above a wall of 4 mm. The samples that the smooth passes change: how many, and how near to the
// wall the nearest of them lies [samples].
struct Smoothed {
  std::int64_t samples = 0;
  double nearest = std::numeric_limits<double>::infinity();
};
Smoothed smoothedBesideAWall(double spacing_mm, bool off_the_edges, std::uint64_t seed) {
  engine::Grid grid;
  grid.width = static_cast<std::int32_t>(30.0 / spacing_mm) + 1;
  grid.height = static_cast<std::int32_t>(10.0 / spacing_mm) + 1;
  grid.spacing_x = grid.spacing_y = spacing_mm;
  const int wall = grid.height / 2;  // the first row of the high land
  std::vector<float> z;
  std::uint32_t noise = 1;
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) {
      noise = noise * 1664525U + 1013904223U;
      z.push_back((r < wall ? 1.0F : 5.0F) + 1e-3F * static_cast<float>(noise >> 28));
    }
  const engine::Version field = engine::makeField(grid, z);
  const double y = (wall - 0.5) * spacing_mm;
  const std::vector<Edge> edges{straight({2.0, y}, {28.0, y})};
  OperatorSpec spec;
  spec.seed = seed;
  spec.mark_passes = 0;
  spec.smooth_offset_mm = 0.6;  // more than three times the hand's own error
  spec.smooth_clear_mm = 0.55;
  if (off_the_edges) spec = offTheEdges(spec, grid);
  Scene scene;
  scene.level = ContactLevel::kCertified;
  scene.certified_radius_cells = 8;
  engine::JobControl job;
  const auto after = replay(field, field, operatorStrokes(field, edges, spec), scene, {}, job);
  EXPECT_TRUE(after);
  Smoothed smoothed;
  const engine::FieldReader a = field.reader(), b = after->field.reader();
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) {
      if (a.heightAt(c, r) == b.heightAt(c, r)) continue;
      ++smoothed.samples;
      smoothed.nearest = std::min(smoothed.nearest, std::abs(r - (wall - 0.5)));
    }
  return smoothed;
}

TEST(OperatorStrokes, OffTheEdgesNothingBesideAWallIsSmoothedHoweverTheHandWanders) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    for (const double spacing_mm : {0.05, 0.2}) {
      const Smoothed off = smoothedBesideAWall(spacing_mm, true, seed);
      EXPECT_GT(off.samples, 100) << seed;
      // "Near edges" is up to three samples.
      EXPECT_GT(off.nearest, 3.0) << seed << ", " << spacing_mm;
    }
    nearest = std::min(nearest, smoothedBesideAWall(0.05, false, seed).nearest);
  }
  // At three times the hand's error alone the tip comes nearer to the wall than it is deep.
  EXPECT_LT(nearest, 1.0);
}

TEST(OperatorStrokes, PassesAreAsManyAsAskedForSmoothBeforeMarkAndParallel) {
  const Edge edge = straight({5, 10}, {30, 10});
  OperatorSpec spec = steady();
  spec.smooth_passes = 2;
  spec.mark_passes = 3;
  spec.mark_offset_mm = 0.4;
  std::vector<Tool> strokes;
  std::vector<double> heights;
  Tool before = Tool::kFeel;
  for (const StrokeSample& row : stroked({edge}, spec)) {
    if (row.tool != before && row.tool != Tool::kFeel) {
      strokes.push_back(row.tool);
      heights.push_back(row.tip_mm.y);
    }
    before = row.tool;
  }
  EXPECT_EQ(strokes,
            (std::vector<Tool>{Tool::kSmooth, Tool::kSmooth, Tool::kMark, Tool::kMark, Tool::kMark}));
  EXPECT_NEAR(heights[2], 9.6, 1e-9);
  EXPECT_NEAR(heights[3], 10.0, 1e-9);
  EXPECT_NEAR(heights[4], 10.4, 1e-9);
}

TEST(OperatorStrokes, ComeDownFromAboveAndLiftClearBetweenStrokes) {
  const auto rows = stroked({straight({5, 5}, {30, 5}), straight({5, 20}, {30, 20})}, {});
  const double top = 2.0 + 0.01 * 400;
  EXPECT_GT(rows.front().tip_mm.z, top);
  EXPECT_GT(rows.back().tip_mm.z, top);
  // Between two strokes the tip gets above the highest point of the scan.
  double highest = top + 1.0;
  Tool before = Tool::kFeel;
  for (const StrokeSample& row : rows) {
    if (row.tool != Tool::kFeel && before == Tool::kFeel) {
      EXPECT_GT(highest, top + 0.5);
      highest = -1.0;
    }
    if (row.tool == Tool::kFeel) highest = std::max(highest, row.tip_mm.z);
    before = row.tool;
  }
}

TEST(OperatorStrokes, MoveWithoutJumps) {
  OperatorSpec spec;
  const auto rows = stroked({straight({5, 5}, {30, 5}), ring({20, 15}, 6)}, spec);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const glm::dvec3 d = rows[i].tip_mm - rows[i - 1].tip_mm;
    // Least jerk peaks at 1.875 of the mean 80 mm/s; the hand adds far less than a tenth of a millimetre.
    EXPECT_LT(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z), 1.875 * 0.08 + 0.1);
  }
}

TEST(OperatorStrokes, KeepTheLastHeightOverAHole) {
  OperatorSpec spec = steady();
  spec.press_mm = 0.3;
  for (const StrokeSample& row : stroked({straight({5, 5}, {30, 5})}, spec, true)) {
    ASSERT_TRUE(std::isfinite(row.tip_mm.z));
    if (row.tool != Tool::kMark || row.tip_mm.x < 15.11 || row.tip_mm.x > 24.89) continue;
    // The last height before the hole is that of the last whole cell, up to x = 15.0.
    EXPECT_NEAR(row.tip_mm.z, 2.0 + 0.1 * 15.0 - 0.3, 0.003);
  }
}

TEST(OperatorStrokes, StayInTheField) {
  OperatorSpec spec;
  spec.wander_mm = 3.0;
  for (const StrokeSample& row : stroked({straight({0, 0}, {40, 30}), straight({0, 30}, {40, 30})}, spec)) {
    EXPECT_GE(row.tip_mm.x, 0.0);
    EXPECT_GE(row.tip_mm.y, 0.0);
    EXPECT_LE(row.tip_mm.x, 400 * 0.1);
    EXPECT_LE(row.tip_mm.y, 300 * 0.1);
  }
}

TEST(OperatorStrokes, AreTheSameForOneSeedAndOthersForAnother) {
  OperatorSpec spec;
  const std::vector<Edge> edges{straight({5, 5}, {30, 20})};
  const auto a = stroked(edges, spec);
  EXPECT_EQ(a, stroked(edges, spec));
  spec.seed = 2;
  EXPECT_NE(a, stroked(edges, spec));
}

TEST(OperatorStrokes, OfNoEdgesOrOnlyShortOnesAreNone) {
  EXPECT_TRUE(stroked({}, {}).empty());
  OperatorSpec spec;
  spec.shortest_mm = 10.0;
  EXPECT_TRUE(stroked({straight({5, 5}, {10, 5})}, spec).empty());
}

TEST(OperatorStrokes, OnAFieldOfOneSampleOrOneRowEndAndAreFinite) {
  engine::Grid grid;
  grid.height = 1;
  for (const int width : {1, 30}) {
    grid.width = width;
    const engine::Version field =
        engine::makeField(grid, std::vector<float>(static_cast<std::size_t>(width), 1.0F));
    const std::vector<Edge> edges{straight({0, 0}, {width - 1.0 + 0.5, 0})};
    const auto rows = operatorStrokes(field, edges, {});
    EXPECT_FALSE(rows.empty());
    for (const StrokeSample& row : rows)
      EXPECT_TRUE(std::isfinite(row.tip_mm.x + row.tip_mm.y + row.tip_mm.z));
  }
}

TEST(HandMotion, HasItsVarianceItsBandAndItsBound) {
  double square = 0.0;
  double farthest = 0.0;
  double crossings = 0.0;
  constexpr int kHands = 200;
  constexpr int kTicks = 2000;
  for (int hand = 0; hand < kHands; ++hand) {
    const HandMotion motion(0.05, 8.0, 12.0, 1, static_cast<std::uint64_t>(hand));
    double before = motion.at(-0.001);
    for (int i = 0; i < kTicks; ++i) {
      const double x = motion.at(i / 1000.0);
      square += x * x;
      farthest = std::max(farthest, std::abs(x));
      crossings += before < 0.0 && x >= 0.0;
      before = x;
    }
  }
  // The mean square over two seconds (20 periods) of each of 1600 sines differs from half its amplitude
  // squared by some 4 % at most, with random sign, and pairs in a hand beat with random phases: 1 % over all
  // hands is three deviations.
  EXPECT_NEAR(square / (kHands * kTicks) / (0.05 * 0.05), 1.0, 0.02);
  EXPECT_LE(farthest, HandMotion::kBound * 0.05);
  // Rice: upward crossings a second = root of the mean square frequency, 10.07 Hz for 8 to 12 Hz.
  EXPECT_NEAR(crossings / (kHands * kTicks / 1000.0), 10.07, 0.3);
}

}  // namespace
}  // namespace fettle::haptic
