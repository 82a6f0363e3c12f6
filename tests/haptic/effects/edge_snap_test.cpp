// Edge snap: distances are exact, the pull is the gradient of one potential, and both follow the marks.
#include "haptic/effects/edge_snap.h"

#include <numbers>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "haptic/effects/stability.h"
#include "tests/engine/filter/edge_line_of.h"
#include "tests/haptic/effects/touch.h"

namespace fettle::haptic {
namespace {

using tests::fieldOf;
using tests::HeldMass;
using tests::sceneOf;
using tests::Touch;
using tests::uniform;

engine::Version marked(const engine::Version& field, const std::vector<std::pair<int, int>>& marks) {
  engine::LiveField live(field, engine::Growth::kAllowed);
  for (const auto& [c, r] : marks) EXPECT_TRUE(live.setMark(c, r, true));
  return live.snapshot();
}

engine::Version flat(int width, int height, double sx, double sy) {
  return fieldOf(
      width, height, [](int, int) { return 0.0; }, sx, sy);
}

// The nearest of all marks, in long double.
void expectExact(const MarkDistance& distance, const engine::FieldReader& f) {
  std::vector<std::pair<int, int>> marks;
  for (int r = 0; r < f.height(); ++r)
    for (int c = 0; c < f.width(); ++c)
      if (f.markedAt(c, r)) marks.emplace_back(c, r);
  const long double reach = distance.reachMm();
  for (int r = 0; r < f.height(); ++r)
    for (int c = 0; c < f.width(); ++c) {
      long double best = reach * reach;
      for (const auto& [mc, mr] : marks) {
        const long double dx = (mc - c) * static_cast<long double>(f.grid().spacingXMm());
        const long double dy = (mr - r) * static_cast<long double>(f.grid().spacingYMm());
        best = std::min(best, dx * dx + dy * dy);
      }
      // One rounding to float, and a hair of double.
      ASSERT_NEAR(distance.at(c, r), static_cast<double>(std::sqrt(best)), 1.3e-7 * distance.reachMm())
          << c << ' ' << r;
    }
}

std::vector<std::pair<int, int>> randomMarks(std::mt19937_64& random, int count, int width, int height) {
  std::vector<std::pair<int, int>> marks;
  for (int i = 0; i < count; ++i)
    marks.emplace_back(static_cast<int>(uniform(random, 0, width)),
                       static_cast<int>(uniform(random, 0, height)));
  return marks;
}

TEST(MarkDistance, IsExactForAnySpacingSizeAndReach) {
  std::mt19937_64 random(1);
  struct Case {
    int width, height;
    double sx, sy, reach;
    int marks;
  };
  for (const Case& k : {Case{150, 140, 0.05, 0.05, 1.0, 12},
                        {130, 70, 0.3, 0.05, 1.5, 6},
                        {70, 130, 0.05, 0.3, 1.5, 6},
                        {200, 1, 0.1, 0.1, 0.7, 3},
                        {1, 200, 0.1, 0.1, 0.7, 3},
                        {1, 1, 1.0, 1.0, 3.0, 1},
                        {64, 64, 0.1, 0.1, 50.0, 2},
                        {129, 129, 0.1, 0.1, 6.3, 1},
                        {90, 90, 1.0, 1.0, 0.5, 40},
                        {80, 80, 0.1, 0.1, 1.0, 2000},
                        {80, 80, 0.1, 0.1, 1.0, 0}}) {
    const engine::Version field =
        marked(flat(k.width, k.height, k.sx, k.sy), randomMarks(random, k.marks, k.width, k.height));
    const MarkDistance distance(field.reader(), nullptr, k.reach);
    EXPECT_EQ(distance.reachMm(), std::min(k.reach, 63 * std::min(k.sx, k.sy)));
    EXPECT_TRUE(distance.upToDate());
    expectExact(distance, field.reader());
  }
}

TEST(MarkDistance, HoldsTilesNearMarksOnly) {
  const engine::Version far_apart = marked(flat(2000, 2000, 0.05, 0.05), {{32, 32}, {1000, 1023}});
  const MarkDistance distance(far_apart.reader(), nullptr, 0.5);
  // The first mark's own tile; the second lies on its tile's upper edge, so one more; and 10 samples from
  // column 1000 (tile 15, 960 .. 1023) nothing else.
  EXPECT_EQ(distance.tilesHeld(), 3);
  // 2000^2 samples in floats would be 16 MB.
  EXPECT_LT(distance.bytesHeld(), 3'000'000U);
  EXPECT_EQ(MarkDistance(flat(2000, 2000, 0.05, 0.05).reader(), nullptr, 0.5).tilesHeld(), 0);
}

TEST(MarkDistance, FollowsMarksDrawnTakenAwayAndReplacedInBoundedSlices) {
  std::mt19937_64 random(2);
  engine::LiveField live(marked(flat(200, 180, 0.1, 0.12), randomMarks(random, 5, 200, 180)),
                         engine::Growth::kAllowed);
  MarkDistance distance(live.reader(), nullptr, 2.0);
  for (int round = 0; round < 12; ++round) {
    const int c = static_cast<int>(uniform(random, 0, 190));
    const int r = static_cast<int>(uniform(random, 0, 170));
    for (int i = 0; i < 8; ++i) {
      ASSERT_TRUE(live.setMark(c + i, r + i / 2, round % 3 != 2));
      distance.markChanged(c + i, r + i / 2, 1, 1);
      distance.advance(live.reader(), nullptr);  // work continues between changes
    }
    int slices = 0;
    while (!distance.upToDate() && slices < 2000) {
      distance.advance(live.reader(), nullptr);
      ++slices;
    }
    // At most 12 tiles are near, 1 + 13 + 16 slices each, and some are begun twice.
    ASSERT_LE(slices, 600);
    expectExact(distance, live.reader());
  }
  // Another version: nobody says where.
  const engine::Version other = marked(flat(200, 180, 0.1, 0.12), {{5, 170}, {100, 64}});
  distance.rescan();
  while (!distance.upToDate()) distance.advance(other.reader(), nullptr);
  expectExact(distance, other.reader());
  EXPECT_EQ(distance.refused(), 0);
}

TEST(MarkDistance, SaysWhenItsMemoryIsUsedUpAndGoesOnWithoutThoseTiles) {
  engine::LiveField live(flat(1000, 1000, 0.1, 0.1), engine::Growth::kAllowed);
  MarkDistance distance(live.reader(), nullptr, 1.0);
  for (int r = 30; r < 1000; r += 64)
    for (int c = 30; c < 1000; c += 64) {
      ASSERT_TRUE(live.setMark(c, r, true));
      distance.markChanged(c, r, 1, 1);
    }
  while (!distance.upToDate()) distance.advance(live.reader(), nullptr);
  EXPECT_EQ(distance.tilesHeld(), MarkDistance::kSpareTiles);
  EXPECT_EQ(distance.refused(), 16 * 16 - MarkDistance::kSpareTiles);
  // What is freed is used again.
  for (int r = 30; r < 1000; r += 64)
    for (int c = 30; c < 1000; c += 64) {
      ASSERT_TRUE(live.setMark(c, r, false));
      distance.markChanged(c, r, 1, 1);
    }
  while (!distance.upToDate()) distance.advance(live.reader(), nullptr);
  EXPECT_EQ(distance.tilesHeld(), 0);
}

Scene snapping(double force, double reach) {
  Scene scene = sceneOf({EffectKind::kSpring, EffectKind::kEdgeSnap});
  scene.params.edge_snap = {force, reach};
  return scene;
}

// Marks along column 100 of a field, 0.05 mm apart.
engine::Version line() {
  std::vector<std::pair<int, int>> marks;
  for (int r = 0; r < 200; ++r) marks.emplace_back(100, r);
  return marked(flat(200, 200, 0.05, 0.05), marks);
}

// After the pull has come on.
ForceSample settled(Touch& touch, const glm::dvec3& at) {
  ForceSample f;
  for (int i = 0; i < 60; ++i) f = touch.at(at);
  return f;
}

TEST(EdgeSnap, PullIsZeroOnTheEdgeFullHalfwayAndZeroAtTheReach) {
  Touch touch(line(), snapping(0.5, 1.0));
  const double edge = 5.0;
  EXPECT_NEAR(settled(touch, {edge, 5.03, -0.5}).force_n.x, 0.0, 1e-9);
  // Away from cusps the spline's slope is that of U but for its third derivative, 8 F / R^2, times h^2 / 6.
  const double close = 8.0 * 0.5 * 0.05 * 0.05 / 6.0 + 1e-6;
  EXPECT_NEAR(settled(touch, {edge + 0.5, 5.03, -0.5}).force_n.x, -0.5, close);
  EXPECT_NEAR(settled(touch, {edge - 0.5, 5.03, -0.5}).force_n.x, 0.5, close);
  EXPECT_NEAR(settled(touch, {edge - 0.25, 5.03, -0.5}).force_n.x, 0.375, close);
  // At the reach the pull has a kink of 4 F / R, which the spline rounds by a quarter of it a cell.
  EXPECT_NEAR(settled(touch, {edge + 1.0, 5.03, -0.5}).force_n.x, 0.0, 0.026);
  EXPECT_EQ(settled(touch, {edge + 1.1, 5.03, -0.5}).force_n.x, 0.0);
  // Along the line, and across the surface, nothing.
  EXPECT_NEAR(settled(touch, {edge - 0.5, 5.03, -0.5}).force_n.y, 0.0, 1e-9);
  EXPECT_NEAR(settled(touch, {edge - 0.5, 5.03, -0.5}).force_n.z, 0.5, 1e-12);
  // And nothing in free space.
  EXPECT_EQ(settled(touch, {edge - 0.5, 5.03, 0.5}).force_n, glm::dvec3(0.0));
}

TEST(EdgeSnap, DoesNoWorkOverClosedLoopsAndHasNoSteps) {
  std::mt19937_64 random(3);
  const engine::Version field = marked(flat(120, 120, 0.1, 0.17), randomMarks(random, 9, 120, 120));
  const EdgeSnap snap({1.0, 2.0}, field.reader(), nullptr);
  const double bound = 4.0 * 1.0 / 2.0;  // 4 F / R
  for (int i = 0; i < 40; ++i) {
    const glm::dvec2 centre{uniform(random, 0.5, 11.0), uniform(random, 0.5, 19.0)};
    // Within the field, 11.9 mm by 20.2 mm.
    const double room = std::min({centre.x, centre.y, 11.9 - centre.x, 20.2 - centre.y});
    const double radius = uniform(random, 0.1, 1.0) * room;
    constexpr int kSteps = 20000;
    double work = 0.0;
    glm::dvec2 before{0.0};
    for (int k = 0; k <= kSteps; ++k) {
      const double turn = 2.0 * std::numbers::pi * k / kSteps;
      const glm::dvec2 at = centre + radius * glm::dvec2(std::cos(turn), std::sin(turn));
      const glm::dvec2 slope = snap.at(at.x, at.y).slope;
      const double h = 2.0 * std::numbers::pi * radius / kSteps;
      if (k > 0) {
        // Trapezoids: second derivatives of the force are 4 F / (R h) at most, over 25 mm of loop.
        work += 0.5 * glm::dot(slope + before, at - centre -
                                                   radius * glm::dvec2(std::cos(turn - h / radius),
                                                                       std::sin(turn - h / radius)));
        // A cusp between two marks turns the whole force over one cell: 2 F / 0.1 mm.
        ASSERT_LE(glm::length(slope - before), (2.0 / 0.1 + bound) * h * 1.5);
      }
      before = slope;
    }
    EXPECT_NEAR(work, 0.0, 2e-5) << i;
  }
}

TEST(EdgeSnap, RestoringStiffnessIsAtMostFourForcesOverTheReach) {
  std::mt19937_64 random(4);
  const engine::Version field = marked(flat(120, 120, 0.1, 0.1), randomMarks(random, 25, 120, 120));
  const EdgeSnap snap({1.0, 2.0}, field.reader(), nullptr);
  double stiffest = 0.0;
  for (int i = 0; i < 200000; ++i) {
    const glm::dvec2 at{uniform(random, 0.3, 11.6), uniform(random, 0.3, 11.6)};
    const double h = 1e-4;
    const double kx = (snap.at(at.x + h, at.y).slope.x - snap.at(at.x - h, at.y).slope.x) / (2 * h);
    const double ky = (snap.at(at.x, at.y + h).slope.y - snap.at(at.x, at.y - h).slope.y) / (2 * h);
    stiffest = std::max({stiffest, kx, ky});
  }
  EXPECT_LE(stiffest, 2.0 * (1 + 1e-6));
  EXPECT_GT(stiffest, 1.5);
}

// A mass of device damping b next to a marked line: whether it swings ever wider.
bool buzzesOnTheLine(const Scene& scene, double b, double rate) {
  Touch touch(line(), scene, rate);
  HeldMass mass{0.05, b};
  mass.x_mm = {5.002, 5.03, -0.5};
  double early = 0.0, late = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 force = touch.at(mass.x_mm).force_n;
    mass.advance({force.x, 0.0, 0.0}, touch.period_s);
    double& most = i < 300 ? early : late;
    if (i < 300 || i >= 1700) most = std::max(most, std::abs(mass.x_mm.x - 5.0));
  }
  return !(late < early);
}

// The stated condition at work: 4 F / R around 2 b / T.
TEST(EdgeSnap, HoldsATipOnTheLineWithoutBuzzUpToItsCondition) {
  const double b = 0.001, rate = 1000.0;
  for (const double reach : {1.0, 3.0})
    for (const double factor : {0.85, 1.2})
      EXPECT_EQ(buzzesOnTheLine(snapping(factor * 2.0 * b * rate * reach / 4.0, reach), b, rate),
                factor > 1.0)
          << reach << ' ' << factor;
}

// A reach of more than 63 samples is cut, and the pull stiffer than 4 F over the reach of the scene: what is taken for stable does
// not buzz, whatever reach a scene states.
TEST(EdgeSnap, DoesNotBuzzWithTheLargestForceThatIsNamedWhereTheFieldCutsTheReach) {
  const double b = 0.001, rate = 1000.0;
  DeviceProfile device;
  device.gives_force = true;
  device.max_stiffness_n_per_mm = 0.85 * 2.0 * b * rate;
  device.max_force_n = 20.0;
  const double longest_mm = MarkDistance::longestReachMm(line().grid());
  EXPECT_DOUBLE_EQ(longest_mm, 63 * 0.05);
  for (const double reach : {2.0, 5.0, 40.0}) {
    Scene scene = snapping(20.0, reach);
    scene.stiffness_n_per_mm = 1.0;
    const auto problem = stabilityProblem(scene, device, rate, 1.0, longest_mm);
    ASSERT_TRUE(problem) << reach;
    EXPECT_EQ(problem->corrected.params.edge_snap.reach_mm, reach) << "what is not named stays";
    EXPECT_DOUBLE_EQ(problem->largest, roundedDown(0.85 * 0.5 * std::min(reach, longest_mm)));
    EXPECT_FALSE(buzzesOnTheLine(problem->corrected, b, rate)) << reach;
    EXPECT_EQ(stabilityProblem(problem->corrected, device, rate, 1.0, longest_mm), std::nullopt) << reach;
    Scene stronger = problem->corrected;
    stronger.params.edge_snap.force_n *= 1.2 / 0.85;
    EXPECT_TRUE(buzzesOnTheLine(stronger, b, rate)) << reach;
    EXPECT_NE(stabilityProblem(stronger, device, rate, 1.0, longest_mm), std::nullopt) << reach;
    // And at the largest scale, as at 1:1.
    EXPECT_NEAR(largestStableScale(problem->corrected, device, rate, longest_mm), 1.0, 2e-3) << reach;
    EXPECT_EQ(stableScene(scene, device, rate, 1.0, longest_mm), problem->corrected) << reach;
  }
}

TEST(EdgeSnap, MarksDrawnUnderTheTipPullSoonAfterAndUnmarkedOnesNoMore) {
  Scene scene = snapping(0.5, 1.0);
  Touch touch(flat(200, 200, 0.05, 0.05), scene);
  EXPECT_EQ(settled(touch, {5.02, 5.02, -0.5}).force_n.x, 0.0);
  for (int i = 0; i < 100; ++i) static_cast<void>(touch.at({5.02, 3.0 + 0.05 * i, -0.5}, Tool::kMark));
  for (int i = 0; i < 500; ++i) static_cast<void>(touch.at({5.5, 5.02, -0.5}));
  EXPECT_NEAR(touch.at({5.5, 5.02, -0.5}).force_n.x, -0.5, 0.01);
  for (int i = 0; i < 100; ++i) static_cast<void>(touch.at({5.02, 3.0 + 0.05 * i, -0.5}, Tool::kUnmark));
  EXPECT_EQ(settled(touch, {5.5, 5.02, -0.5}).force_n.x, 0.0);
}

TEST(EdgeSnap, MarksOfAnAdoptedVersionPullSoonAfterAndComeOnWithoutAKick) {
  Touch touch(flat(200, 200, 0.05, 0.05), snapping(0.5, 1.0));
  static_cast<void>(settled(touch, {5.5, 5.02, -0.5}));
  const engine::Version left = touch.field.adopt(line());
  touch.tick.fieldChanged();
  double last = touch.at({5.5, 5.02, -0.5}).force_n.x;
  EXPECT_EQ(last, 0.0);
  for (int i = 0; i < 800; ++i) last = touch.at({5.5, 5.02, -0.5}).force_n.x;
  EXPECT_NEAR(last, -0.5, 0.01);
  // Lifting and touching down: from nothing, in small steps.
  static_cast<void>(touch.at({5.5, 5.02, 0.5}));
  last = 0.0;
  for (int i = 0; i < 60; ++i) {
    const double now = touch.at({5.5, 5.02, -0.5}).force_n.x;
    EXPECT_LE(std::abs(now - last), 0.5 / 50 * 1.01);
    last = now;
  }
  EXPECT_NEAR(last, -0.5, 0.01);
}

engine::Version lined(const engine::Version& field, const std::vector<engine::EdgeLine>& lines) {
  return field.withLines(std::make_shared<const std::vector<engine::EdgeLine>>(lines));
}

// A step and a crease: both pull.
std::vector<engine::EdgeLine> stepAndCrease() {
  std::vector<engine::EdgeLine> lines{engine::tests::edgeLineOf({{12.3, 8.0}, {150.6, 71.2}, {90.0, 170.0}}),
                                      engine::tests::edgeLineOf({{60.0, 100.0}, {10.0, 140.5}})};
  for (engine::EdgePoint& point : lines[1].points) point.kind = engine::LineKind::kCrease;
  return lines;
}

TEST(MarkDistance, CountsTheSamplesThatLinesPass) {
  const engine::Version plain = marked(flat(200, 180, 0.1, 0.12), {{150, 20}});
  const engine::Version with = lined(plain, stepAndCrease());
  const MarkDistance distance(with.reader(), with.lineCuts(), 2.0);
  // The same samples, marked instead.
  engine::LiveField live(plain, engine::Growth::kAllowed);
  for (int tr = 0; tr < 3; ++tr)
    for (int tc = 0; tc < 4; ++tc)
      for (const engine::LineSample& sample : with.lineCuts()->samplesOf(tc, tr).samples)
        ASSERT_TRUE(live.setMark(sample.column, sample.row, true));
  expectExact(distance, live.reader());
  // Lines that come and go with a version, as those of an undone stroke.
  MarkDistance follows(plain.reader(), nullptr, 2.0);
  expectExact(follows, plain.reader());
  follows.rescan();
  while (!follows.upToDate()) follows.advance(with.reader(), with.lineCuts());
  expectExact(follows, live.reader());
  follows.rescan();
  while (!follows.upToDate()) follows.advance(plain.reader(), nullptr);
  expectExact(follows, plain.reader());
}

TEST(EdgeSnap, PullsToTheLinesOfAnAdoptedVersion) {
  const engine::Version plain = flat(200, 200, 0.05, 0.05);
  Touch touch(plain, snapping(0.5, 1.0));
  EXPECT_EQ(settled(touch, {5.5, 5.02, -0.5}).force_n.x, 0.0);
  const engine::Version left =
      touch.field.adopt(lined(plain, {engine::tests::edgeLineOf({{100.2, -5.0}, {100.2, 205.0}})}));
  touch.tick.fieldChanged();
  for (int i = 0; i < 800; ++i) static_cast<void>(touch.at({5.5, 5.02, -0.5}));
  EXPECT_NEAR(touch.at({5.5, 5.02, -0.5}).force_n.x, -0.5, 0.01);
  EXPECT_NEAR(touch.at({4.5, 5.02, -0.5}).force_n.x, 0.5, 0.01);
}

TEST(EdgeSnap, HardInputsGiveFiniteForcesWithinTheLimit) {
  std::mt19937_64 random(9);
  for (const auto& [w, h] : {std::pair{40, 40}, {40, 2}, {2, 40}, {1, 40}, {40, 1}, {1, 1}}) {
    const engine::Version field =
        marked(fieldOf(
                   w, h, [](int c, int r) { return (c + r) % 7 == 3 ? 1e6 : (c * r % 5 == 4 ? NAN : 0.0); },
                   0.05, 2.0),
               randomMarks(random, 5, w, h));
    Touch touch(field, snapping(20.0, 50.0));
    for (int i = 0; i < 3000; ++i) {
      glm::dvec3 e{uniform(random, -1, 3), uniform(random, -5, 90), uniform(random, -9, 9)};
      if (i % 100 == 0) e[i / 100 % 3] = i % 200 == 0 ? HUGE_VAL : std::nan("");
      if (i % 100 == 50) e *= 1e300;
      if (i % 100 == 51) e *= 1e-310;
      ASSERT_LE(glm::length(touch.at(e, static_cast<Tool>(i / 50 % kTools)).force_n), 8.0 * (1 + 1e-12));
    }
  }
}

}  // namespace
}  // namespace fettle::haptic
