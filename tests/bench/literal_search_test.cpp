// Level paper against the source's search word for word, tick by tick.
#include "bench/accuracy/literal_search.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "bench/accuracy/subjects.h"
#include "engine/field/live_field.h"
#include "haptic/contact/certified.h"
#include "haptic/contact/closest_on_cell.h"
#include "haptic/tick/tick.h"
#include "haptic/trials/hand_stroke.h"
#include "tests/haptic/support/fields.h"

namespace fettle::bench {
namespace {

// Around its minimum squared distance rises with the square of the way: a point that looks equally near in double
// precision may lie aside by the square root of a rounding, 1.5e-8, times the distance, here at most 3 mm.
constexpr double kAsideMm = 1e-7;

struct Difference {
  std::int64_t contacts = 0, flags = 0, points = 0, cells = 0;
};

Difference compare(const engine::Version& field, const trials::HandMotion& motion,
                   haptic::ContactLevel level) {
  haptic::Scene scene = haptic::defaultScene();
  scene.level = level;
  engine::LiveField live(field, engine::Growth::kAllowed);
  haptic::Tick tick(scene, live, field);
  LiteralTracker literal(field);
  Difference difference;
  for (const haptic::StrokeSample& s : trials::handStroke(field, motion)) {
    const haptic::ForceSample felt = tick.run(s);
    LiteralPoint point;
    const bool touches = literal.update(s.tip_mm, point);
    difference.flags += touches != felt.contact ? 1 : 0;
    if (!touches || !felt.contact) continue;
    ++difference.contacts;
    difference.points += glm::length(point.position_mm - felt.proxy_mm) > kAsideMm ? 1 : 0;
    difference.cells += tick.contact().proxy.cell == point.cell ? 0 : 1;
  }
  return difference;
}

TEST(LiteralSearch, LevelPaperFindsTheSamePointInTheSameCellInEveryTickOnEveryGround) {
  const auto grounds = searchGrounds(256);
  ASSERT_TRUE(grounds) << grounds.error().line();
  std::int64_t descent_elsewhere = 0;
  for (const Subject& ground : *grounds)
    for (const double speed_mm_s : {10.0, 50.0}) {
      trials::HandMotion motion;
      motion.ticks = 20'000;
      motion.speed_mm_s = speed_mm_s;
      const Difference paper = compare(ground.field, motion, haptic::ContactLevel::kPaper);
      EXPECT_GT(paper.contacts, 5000) << ground.name;
      EXPECT_EQ(paper.flags, 0) << ground.name << ' ' << speed_mm_s;
      EXPECT_EQ(paper.points, 0) << ground.name << ' ' << speed_mm_s;
      EXPECT_EQ(paper.cells, 0) << ground.name << ' ' << speed_mm_s;
      descent_elsewhere += compare(ground.field, motion, haptic::ContactLevel::kDescent).points;
    }
  // The comparison sees a search of another rule.
  EXPECT_GT(descent_elsewhere, 10'000);
}

// On the flank of a needle the nearest point is level with the endpoint but for the distance over the slope: with needles
// 1e6 mm high that is less than a rounding of the heights there, which then decides on which side the endpoint is. Both
// searches find the same point in the same cell; where only one of the two touches, the heights of point and endpoint
// differ by roundings alone, so that no scan of more places would make the flags the same.
TEST(LiteralSearch, OnNeedlesOnlyARoundingOfTheirHeightsDecidesWhichOfTheTwoTouches) {
  for (const double needle_mm : {1e3, 1e5, 1e6}) {
    const auto field = fieldOf(
        256, 0.05, [&](int column, int row) { return column % 7 == 3 && row % 5 == 2 ? needle_mm : 0.0; });
    ASSERT_TRUE(field);
    engine::LiveField live(*field, engine::Growth::kAllowed);
    haptic::Tick tick(haptic::defaultScene(), live, *field);
    LiteralTracker literal(*field);
    trials::HandMotion motion;
    motion.ticks = 20'000;
    motion.speed_mm_s = 20.0;
    int contacts = 0, flags = 0;
    for (const haptic::StrokeSample& s : trials::handStroke(*field, motion)) {
      const bool felt = tick.run(s).contact;
      LiteralPoint point;
      const bool touches = literal.update(s.tip_mm, point);
      const haptic::SurfacePoint& proxy = tick.contact().proxy;
      if (felt && touches) {
        ++contacts;
        EXPECT_EQ(proxy.cell, point.cell) << needle_mm << " at " << s.t;
        EXPECT_LE(glm::length(proxy.position_mm - point.position_mm), kAsideMm) << needle_mm << " at " << s.t;
      } else if (felt != touches) {
        ++flags;
        // Of the height: a sum of four products of numbers as large as the needle, each rounded twice.
        const double z = felt ? proxy.position_mm.z : point.position_mm.z;
        EXPECT_LE(std::abs(z - s.tip_mm.z), 8 * 1.2e-16 * needle_mm) << needle_mm << " at " << s.t;
        // No force that could be felt: 1e-6 mm.
        EXPECT_LE(felt ? proxy.distance2_mm2 : point.distance2_mm2, 1e-12) << needle_mm << " at " << s.t;
      }
    }
    EXPECT_GT(contacts, 15'000);
    EXPECT_LE(flags, needle_mm > 1e3 ? 100 : 0) << needle_mm;
  }
}

// Of single cells, convex and twisted, with endpoints on every side of them.
TEST(LiteralSearch, TheBoundedClosestPointOfACellIsTheNearestOfAll) {
  std::mt19937_64 random(71);
  int on_edges = 0;
  for (int i = 0; i < 4000; ++i) {
    const engine::Version field = tests::randomField(random, 3, 3, i, tests::uniform(random, 0.2, 2.0),
                                                     tests::uniform(random, 0.2, 2.0));
    haptic::Surface surface(field.reader());
    const LiteralSearch literal(field);
    const glm::dvec3 e{tests::uniform(random, -1, 4), tests::uniform(random, -1, 4),
                       tests::uniform(random, -8, 8)};
    haptic::Patch patch;
    ASSERT_TRUE(surface.patch({1, 0}, patch));
    LiteralPoint plain;
    ASSERT_TRUE(literal.bounded({1, 0}, e, plain));
    const double u0 = tests::uniform(random, 0, 1), v0 = i % 2 == 0 ? 0.0 : tests::uniform(random, 0, 1);
    const haptic::PatchPoint found = haptic::closestOnCell(patch, e, u0, v0);
    const haptic::PatchPoint whole = haptic::closestOnWholePatch(patch, e);
    // Heights up to 1e6 next to distances of 1: their rounding, times the distance.
    const double rounding = i % 6 == 4 ? 1e-4 : 1e-12;
    EXPECT_LE(found.distance2_mm2, plain.distance2_mm2 * (1 + 1e-12) + rounding) << i;
    EXPECT_LE(plain.distance2_mm2, found.distance2_mm2 * (1 + 1e-12) + rounding) << i;
    EXPECT_NEAR(found.distance2_mm2, whole.distance2_mm2, whole.distance2_mm2 * 1e-12 + rounding) << i;
    const haptic::PatchPoint edges = haptic::closestOnEdges(patch, e);
    EXPECT_GE(edges.distance2_mm2, found.distance2_mm2 * (1 - 1e-12) - rounding) << i;
    on_edges += edges.distance2_mm2 <= found.distance2_mm2 * (1 + 1e-12) + rounding ? 1 : 0;
  }
  EXPECT_GT(on_edges, 500);
  EXPECT_LT(on_edges, 3900);
}

}  // namespace
}  // namespace fettle::bench
