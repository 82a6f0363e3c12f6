// The ball: against closed forms, against brute force on the grown material, and under edits, holes and
// haste.
#include "haptic/contact/sphere_tip.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "haptic/contact/certified.h"
#include "haptic/contact/sphere_solve.h"
#include "haptic/tick/tick.h"
#include "tests/haptic/support/fields.h"

namespace fettle::haptic {
namespace {

using tests::fieldOf;
using tests::kHole;
using tests::randomField;
using tests::uniform;

// Squared distance from a centre to the surface of all cells, in long double.
long double bruteDistance(Surface& surface, const glm::dvec3& centre, double reach) {
  long double best = HUGE_VALL;
  Patch patch;
  for (std::int32_t r = 0; r < surface.cellRows(); ++r)
    for (std::int32_t c = 0; c < surface.cellColumns(); ++c) {
      if (std::abs((c + 0.5) * surface.spacingX() - centre.x) > reach + surface.spacingX() ||
          std::abs((r + 0.5) * surface.spacingY() - centre.y) > reach + surface.spacingY())
        continue;
      if (!surface.patch({c, r}, patch)) continue;
      best = std::min(best, tests::bruteDistance2(patch, centre));
    }
  return std::sqrt(best);
}

// Whether a ball there is out of the surface, walls left out.
bool freeOf(Surface& surface, const glm::dvec3& centre, double radius) {
  CellIndex cell;
  Patch patch;
  if (surface.cellUnder(centre, cell) && surface.patch(cell, patch) && belowPatch(patch, centre))
    return false;
  return bruteDistance(surface, centre, radius) >= static_cast<long double>(radius);
}

struct Ball {
  Ball(const engine::Version& start, double radius, int most_steps = kSphereSteps, int most_work = kBallWork)
      : field(start),
        surface(field.reader()),
        tracker(radius, field.grid(), most_steps, SphereSearch::kBounded, kBallSearches, BallMinima::kAll,
                BallSteps::kInPlan, most_work) {}
  Contact at(double x, double y, double z) { return tracker.update(surface, {x, y, z}, counters); }
  // Until it rests: what one tick's steps do not reach, the next does.
  Contact settle(double x, double y, double z, int ticks = 60) {
    Contact contact;
    for (int i = 0; i < ticks; ++i) contact = at(x, y, z);
    return contact;
  }

  engine::Version field;
  Surface surface;
  SphereTracker tracker;
  TickCounters counters;
};

TEST(SphereTip, RestsOneRadiusAboveAFlatAndIsPushedStraightUp) {
  Ball ball(fieldOf(20, 20, [](int, int) { return 2.0; }), 1.5);
  EXPECT_FALSE(ball.at(7.3, 6.6, 5.0).touching);
  EXPECT_FALSE(ball.at(7.3, 6.6, 3.5).touching);  // touches without pressing
  const Contact c = ball.at(7.3, 6.6, 3.0);
  ASSERT_TRUE(c.touching);
  EXPECT_NEAR(ball.tracker.centre().z, 3.5, 1e-12);
  EXPECT_NEAR(c.penetration_mm.z, 0.5, 1e-12);
  // Feet are found to 1e-6 of a cell, which changes the distance by the square of that.
  EXPECT_NEAR(glm::length(c.proxy.position_mm - glm::dvec3(7.3, 6.6, 2.0)), 0.0, 3e-6);
  EXPECT_NEAR(ball.tracker.pressed().normal.z, 1.0, 1e-11);
  // Dragged along it crosses cells as if there were none.
  const Contact d = ball.settle(11.9, 8.2, 1.0, 20);
  EXPECT_NEAR(glm::length(ball.tracker.centre() - glm::dvec3(11.9, 8.2, 3.5)), 0.0, 1e-4);
  EXPECT_NEAR(d.penetration_mm.z, 2.5, 1e-6);
}

TEST(SphereTip, OfMoreThanSixteenOfTheSmallerSpacingIsRefusedWithThatRadius) {
  for (const auto& [sx, sy] : {std::pair{0.5, 2.0}, {2.0, 0.5}}) {
    const engine::Version field = fieldOf(
        20, 20, [](int, int) { return 0.0; }, sx, sy);
    EXPECT_FALSE(sphereProblem(16.0 * 0.5, field.grid()));
    const auto problem = sphereProblem(16.0 * 0.5 + 1e-9, field.grid());
    ASSERT_TRUE(problem);
    EXPECT_NE(problem->find("at most 8 mm"), std::string::npos) << *problem;
    EXPECT_TRUE(sphereProblem(0.0, field.grid()));
  }
}

TEST(SphereTip, TiltedPlaneInAnisotropicMillimetresPushesAlongItsNormal) {
  // z = 0.5 x + 0.25 y mm with 0.5 mm by 2 mm cells.
  Ball ball(fieldOf(
                60, 20, [](int c, int r) { return 0.25 * c + 0.5 * r; }, 0.5, 2.0),
            1.2);
  const glm::dvec3 normal = glm::normalize(glm::dvec3(-0.5, -0.25, 1.0));
  const glm::dvec3 foot{11.1, 17.2, 0.5 * 11.1 + 0.25 * 17.2};
  const glm::dvec3 e = foot + (1.2 - 0.9) * normal;
  const Contact c = ball.settle(e.x, e.y, e.z);
  ASSERT_TRUE(c.touching);
  EXPECT_NEAR(glm::length(c.penetration_mm - 0.9 * normal), 0.0, 1e-4);
  // Feet are found to 1e-6 of a cell of 2 mm, seen from 1.2 mm.
  EXPECT_NEAR(glm::length(ball.tracker.pressed().normal - normal), 0.0, 2e-6 * 2.0 / 1.2);
}

TEST(SphereTip, VGrooveHoldsItOnBothWallsAtTheKnownHeight) {
  // Walls of slope s meet at column 10: a ball of radius r rests with its centre r sqrt(1 + s^2) above the
  // bottom, because its distance to each wall is (height) / sqrt(1 + s^2).
  for (const double slope : {0.3, 1.0, 2.5}) {
    Ball ball(fieldOf(21, 12, [&](int c, int) { return slope * std::abs(c - 10.0); }), 1.3);
    const double height = 1.3 * std::sqrt(1.0 + slope * slope);
    glm::dvec3 last{0.0};
    for (int i = 0; i < 200; ++i) {
      // A trembling hand below the bottom: never far enough to the side to climb a wall.
      const double x = 10.0 + 0.2 * std::sin(0.7 * i) * slope;
      const Contact c = ball.at(x, 5.5, height - 2.0);
      ASSERT_TRUE(c.touching);
      if (i < 40) continue;
      const glm::dvec3 centre = ball.tracker.centre();
      EXPECT_NEAR(centre.x, 10.0, 1e-5);
      EXPECT_NEAR(centre.z, height, 1e-5);
      if (i > 40) {
        EXPECT_LT(glm::length(centre - last), 1e-5);  // no jumping between the walls
      }
      last = centre;
    }
    EXPECT_EQ(ball.counters.search_bound_hits, 0);
  }
}

TEST(SphereTip, RestsAgainstAStepAsADiscDoesInACorner) {
  // A wall from 0 to 6 within one cell: slope 6. In the corner the ball touches floor and wall.
  Ball ball(fieldOf(30, 12, [](int c, int) { return c < 15 ? 0.0 : 6.0; }), 1.0);
  EXPECT_FALSE(ball.at(10.0, 5.5, 1.2).touching);
  glm::dvec3 e{10.0, 5.5, 0.3};
  // Up to here the wall pushes back more than the hand pulls up along it.
  while (e.x < 15.0) {
    e.x += 0.4;
    ASSERT_TRUE(ball.at(e.x, e.y, e.z).touching);
  }
  // The wall's plane through (14, 0) with slope 6: distance (6 (14 - x) + z) / sqrt(37) = 1 with z = 1.
  EXPECT_NEAR(ball.tracker.centre().z, 1.0, 1e-5);
  EXPECT_NEAR(ball.tracker.centre().x, 14.0 - (std::sqrt(37.0) - 1.0) / 6.0, 1e-5);
}

TEST(SphereTip, DoesNotPassThroughARidgeOneSampleWide) {
  for (const double height : {0.6, 5.0}) {
    Ball ball(fieldOf(40, 12, [&](int c, int) { return c == 20 ? height : 0.0; }), 2.0);
    EXPECT_FALSE(ball.at(10.0, 5.5, 2.1).touching);
    for (double x = 10.0; x < 30.0; x += 3.0) (void)ball.at(x, 5.5, -1.0);
    for (int i = 0; i < 5; ++i) (void)ball.at(30.0, 5.5, -1.0);
    if (height > 2.0) {
      EXPECT_LT(ball.tracker.centre().x, 20.0) << height;
      EXPECT_NEAR(ball.tracker.centre().z, 2.0, 1e-4);
    }
    EXPECT_GE(bruteDistance(ball.surface, ball.tracker.centre(), 3.0), 2.0 - 1e-5);
  }
}

TEST(SphereTip, SpikeOfAMillionIsANeedleThatHoldsItSideways) {
  Ball ball(fieldOf(20, 20, [](int c, int r) { return c == 10 && r == 10 ? 1e6 : 0.0; }), 1.5);
  EXPECT_FALSE(ball.at(5.0, 10.0, 2.0).touching);
  for (double x = 5.0; x <= 9.9; x += 0.35) (void)ball.at(x, 10.0, 1.0);
  const glm::dvec3 c = ball.tracker.centre();
  // The needle's flank at height z is 1 - z / 1e6 of a cell wide at its foot: it stands on a cell's width.
  EXPECT_LT(c.x, 10.0 - 1.5);
  EXPECT_GE(c.z, 1.5 - 1e-6);
  EXPECT_TRUE(std::isfinite(c.x + c.y + c.z));
}

TEST(SphereTip, RestsOnAHoleTooSmallForItAndIsHeldByTheWallsOfALargerOne) {
  const auto holed = [](double half) {
    return fieldOf(41, 41, [=](int c, int r) {
      return std::abs(c - 20) <= half && std::abs(r - 20) <= half ? static_cast<double>(kHole) : 0.0;
    });
  };
  // Samples 19..21 are missing, so cells from 18 to 22 are: a square of 4 by 4. A ball of radius 3 rests on
  // its four sides: 2 from the middle, so sqrt(9 - 4) high.
  Ball small(holed(1), 3.0);
  const Contact rest = small.settle(20.0, 20.0, 1.0);
  ASSERT_TRUE(rest.touching);
  EXPECT_NEAR(small.tracker.centre().z, std::sqrt(5.0), 1e-4);
  EXPECT_NEAR(small.tracker.centre().x, 20.0, 1e-3);
  // A hole from 14 to 26: a ball of radius 2 falls in, and its walls hold it 2 away.
  Ball large(holed(5), 2.0);
  EXPECT_FALSE(large.at(20.0, 20.0, 3.0).touching);
  for (double z = 3.0; z > -6.0; z -= 0.5) EXPECT_FALSE(large.at(20.0, 20.0, z).touching);
  for (double x = 20.0; x < 30.0; x += 0.5) (void)large.at(x, 20.3, -6.0);
  const Contact wall = large.at(30.0, 20.3, -6.0);
  ASSERT_TRUE(wall.touching);
  EXPECT_NEAR(large.tracker.centre().x, 24.0, 1e-6);
  EXPECT_NEAR(large.tracker.centre().z, -6.0, 1e-6);
  EXPECT_NEAR(glm::length(large.tracker.pressed().normal - glm::dvec3(-1, 0, 0)), 0.0, 1e-9);
}

TEST(SphereTip, BesideTheFieldItsSideHoldsAndFieldsWithoutCellsDoNothing) {
  Ball ball(fieldOf(20, 20, [](int, int) { return 0.0; }), 1.0);
  EXPECT_FALSE(ball.at(-5.0, 10.0, -2.0).touching);
  for (double x = -5.0; x < 3.0; x += 0.5) (void)ball.at(x, 10.2, -2.0);
  EXPECT_NEAR(ball.tracker.centre().x, -1.0, 1e-6);
  EXPECT_FALSE(ball.at(-300.0, 10.0, -2.0).touching);
  for (const auto& [w, h] : {std::pair{9, 1}, {1, 9}, {1, 1}}) {
    Ball none(fieldOf(w, h, [](int, int) { return 1.0; }), 1.0);
    EXPECT_FALSE(none.at(0.0, 0.0, 0.0).touching);
    EXPECT_FALSE(none.at(0.0, 0.0, -3.0).touching);
  }
  Ball far(fieldOf(20, 20, [](int, int) { return 0.0; }), 1.0);
  for (const double big : {1e300, -1e300, 1e150, 4e18}) {
    (void)far.at(big, -big, big);
    (void)far.at(3.0, 3.0, 5.0);
    EXPECT_NEAR(glm::length(far.tracker.centre() - glm::dvec3(3.0, 3.0, 5.0)), 0.0, 1e-12);
  }
}

TEST(SphereTip, StaysOutOfRandomFieldsAndNoCentreNearbyIsBetter) {
  std::mt19937_64 random(77);
  int touched = 0;
  for (int i = 0; i < 36; ++i) {
    if (i % 6 == 4) continue;  // spikes: a case of their own
    const double sy = i % 2 == 0 ? 1.0 : 0.6;
    const engine::Version field = randomField(random, 18, 18, i, 1.0, sy, i % 5 == 0 ? 0.03 : 0.0);
    const double radius = i % 3 == 0 ? 0.5 : (i % 3 == 1 ? 1.4 : 2.4);
    Ball ball(field, radius);
    glm::dvec3 e{uniform(random, 5, 12), sy * uniform(random, 5, 12), 12.0};
    (void)ball.at(e.x, e.y, e.z);
    for (int k = 0; k < 6; ++k) {
      e = {uniform(random, 4, 13), sy * uniform(random, 4, 13), uniform(random, -3, 3)};
      const Contact contact = ball.settle(e.x, e.y, e.z, 12);
      const glm::dvec3 c = ball.tracker.centre();
      const double tolerance = ball.tracker.toleranceMm(c.z) + 1e-9;
      ASSERT_GE(bruteDistance(ball.surface, c, radius + 0.5), radius - tolerance)
          << "field " << i << " move " << k << " centre " << c.x << ' ' << c.y << ' ' << c.z << " endpoint "
          << e.x << ' ' << e.y << ' ' << e.z;
      if (!contact.touching) {
        EXPECT_EQ(c, e);
        continue;
      }
      ++touched;
      // The touch is on the surface and one radius away, but for walls.
      EXPECT_NEAR(glm::length(c - contact.proxy.position_mm), radius, 1e-4) << "field " << i;
      if (i % 5 == 0) continue;  // walls of holes hold it too, and freeOf leaves them out
      // Moves of a hundredth of a cell towards anywhere: those that stay free are not nearer to the endpoint
      // than a resting step could still bring.
      const double here = glm::length(c - e);
      for (int t = 0; t < 20; ++t) {
        const glm::dvec3 way = glm::normalize(
            glm::dvec3(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)));
        const glm::dvec3 to = c + 0.01 * way;
        if (glm::length(to - e) >= here - 2e-4) continue;
        EXPECT_FALSE(freeOf(ball.surface, to, radius)) << "field " << i << " step " << k;
      }
    }
  }
  EXPECT_GT(touched, 60);
}

TEST(SphereTip, FewStepsATickEndWhereManyDoAndNoTickTakesMore) {
  std::mt19937_64 random(78);
  int touched = 0;
  int same = 0;
  for (int i = 0; i < 40; ++i) {
    // Slopes and waves; in noise a ball has many places to rest at.
    const engine::Version field = randomField(random, 18, 18, i % 2, 1.0, 1.0);
    Ball many(field, 1.4);
    Ball few(field, 1.4, 2);
    const glm::dvec3 above{uniform(random, 6, 11), uniform(random, 6, 11), 20.0};
    (void)many.at(above.x, above.y, above.z);
    (void)few.at(above.x, above.y, above.z);
    const glm::dvec3 e{above.x, above.y, uniform(random, -1, 0)};
    const Contact all = many.settle(e.x, e.y, e.z, 40);
    double before = HUGE_VAL;
    Contact some;
    for (int tick = 0; tick < 80; ++tick) {
      some = few.at(e.x, e.y, e.z);
      const glm::dvec3 c = few.tracker.centre();
      const double tolerance = few.tracker.toleranceMm(c.z) + 1e-9;
      if (tick < 16) {
        ASSERT_GE(bruteDistance(few.surface, c, 1.9), 1.4 - tolerance);
      }
      EXPECT_LE(glm::length(c - e), before + 2.0 * tolerance);
      before = glm::length(c - e);
    }
    EXPECT_LE(few.counters.longest_search, 2);
    if (!all.touching || !some.touching) continue;
    ++touched;
    same += glm::length(many.tracker.centre() - few.tracker.centre()) < 1e-2 ? 1 : 0;
  }
  EXPECT_GT(touched, 30);
  EXPECT_GT(same, 0.9 * touched) << same << " of " << touched;
}

// Among needles and pits: what a tick's bound of steep cells ends, the next ones go on with. Work is counted where it is bounded.
TEST(SphereTip, StepsThatABoundOfWorkEndsLeadWhereWholeOnesDo) {
  std::mt19937_64 random(80);
  int places = 0, same = 0, worked = 0;
  for (int i = 0; i < 60; ++i) {
    const engine::Version field = randomField(random, 24, 24, 2 + i % 3, 1.0, 1.0);
    Ball whole(field, 2.0, 1, 0), cut(field, 2.0, 1, 1);
    const auto both = [&](const glm::dvec3& to, int ticks) {
      (void)whole.settle(to.x, to.y, to.z, ticks);
      EXPECT_EQ(whole.tracker.work(), 0);
      for (int tick = 0; tick < 5 * ticks; ++tick) {
        (void)cut.at(to.x, to.y, to.z);
        worked += cut.tracker.work() > 0 ? 1 : 0;
      }
    };
    both({uniform(random, 8, 15), uniform(random, 8, 15), 30.0}, 1);
    for (int k = 0; k < 5; ++k) {
      both({uniform(random, 6, 17), uniform(random, 6, 17), uniform(random, -3, 15)}, 30);
      ++places;
      same += glm::length(whole.tracker.centre() - cut.tracker.centre()) < 1e-2 ? 1 : 0;
    }
  }
  EXPECT_GT(worked, 1000);
  // Elsewhere it rests at another place: among needles a ball has many. 85 of 100 places were the same when this was written.
  EXPECT_GT(same, 0.75 * places) << same << " of " << places;
}

// Ways through the air are cleared by bounds of blocks of 8 samples, at most 8 x 8 of them; longer ones are searched. Both
// arrive at once.
TEST(SphereTip, WaysThroughTheAirAreClearedByBoundsUpToEightBlocks) {
  // A tower in a corner, so that not all of the field is below the ball.
  for (const bool along_x : {true, false}) {
    Ball ball(fieldOf(160, 160, [](int c, int r) { return c > 150 && r > 150 ? 50.0 : 0.0; }), 1.5);
    const auto to = [&](double along) {
      EXPECT_FALSE(ball.at(along_x ? along : 20.0, along_x ? 20.0 : along, 9.0).touching);
      EXPECT_EQ(ball.tracker.centre(), glm::dvec3(along_x ? along : 20.0, along_x ? 20.0 : along, 9.0));
      return ball.tracker.searches();
    };
    EXPECT_EQ(to(10.0), 0);  // samples 8 to 12: two blocks
    EXPECT_EQ(to(61.0), 0);  // samples 8 to 63, block 1 to 7
    EXPECT_EQ(to(10.0), 0);
    EXPECT_EQ(to(69.0), 0);  // to 71: block 8, the eighth
    EXPECT_GT(to(5.0), 0);   // samples 3 to 71: nine
    EXPECT_GT(to(100.0), 0);
  }
}

TEST(SphereTip, TendsToTheCertifiedClosestPointAsItShrinks) {
  // Gentle slopes, where the closest point is the only one there is near.
  std::mt19937_64 random(5);
  const engine::Version field = randomField(random, 30, 30, 0, 1.0, 1.0);
  Surface surface(field.reader());
  for (int i = 0; i < 40; ++i) {
    const glm::dvec3 e{uniform(random, 8, 22), uniform(random, 8, 22), -0.05};
    SurfacePoint closest;
    ASSERT_TRUE(certifiedClosest(surface, e, 2.0, closest));
    double last = HUGE_VAL;
    for (const double radius : {1e-1, 1e-2, 1e-3}) {
      Ball ball(field, radius);
      (void)ball.at(e.x, e.y, 3.0);
      const Contact c = ball.settle(e.x, e.y, e.z + 0.0, 20);
      ASSERT_TRUE(c.touching);
      const double off = std::abs(glm::length(c.penetration_mm) - std::sqrt(closest.distance2_mm2));
      // The grown surface is at most a radius farther away than the surface.
      EXPECT_LE(off, radius + 1e-4) << i;
      last = off;
    }
    EXPECT_LT(last, 1.1e-3);
  }
}

TEST(SphereTip, EditUnderARestingBallIsFeltAtTheNextTick) {
  const auto at = [](double z) { return fieldOf(20, 20, [=](int, int) { return z; }); };
  const engine::Version low = at(0.0);
  const engine::Version high = at(10.0);
  const engine::Version little = at(0.05);
  Ball ball(low, 1.0);
  (void)ball.settle(9.5, 9.5, 0.5, 3);
  ball.surface.refresh(little.reader());
  (void)ball.at(9.5, 9.5, 0.5);
  EXPECT_NEAR(ball.tracker.centre().z, 1.05, 1e-5);
  ball.surface.refresh(high.reader());
  (void)ball.at(9.5, 9.5, 0.5);
  EXPECT_NEAR(ball.tracker.centre().z, 11.0, 1e-4);
  ball.surface.refresh(low.reader());
  for (int i = 0; i < 10; ++i) (void)ball.at(9.5, 9.5, 0.5);
  EXPECT_NEAR(ball.tracker.centre().z, 1.0, 1e-5);
}

TEST(SphereTip, BadInputEndsContactAndAPointSceneHoldsNothingOfIt) {
  const engine::Version field = fieldOf(20, 20, [](int, int) { return 0.0; });
  Scene scene;
  {
    engine::LiveField live(field, engine::Growth::kAllowed);
    Tick tick(scene, live, field);
    EXPECT_EQ(tick.tipBytes(), 0u);
  }
  scene.tip = TipShape::kSphere;
  scene.tip_radius_mm = 2.0;
  engine::LiveField live(field, engine::Growth::kAllowed);
  Tick tick(scene, live, field);
  EXPECT_GE(tick.tipBytes(), sizeof(SphereTracker));
  EXPECT_NEAR(tick.run({0.0, {9.0, 9.0, 1.5}, Tool::kFeel}).force_n.z, 0.5, 1e-9);
  EXPECT_FALSE(tick.run({0.0, {9.0, NAN, 1.5}, Tool::kFeel}).contact);
  EXPECT_NEAR(tick.run({0.0, {9.0, 9.0, 1.5}, Tool::kFeel}).force_n.z, 0.5, 1e-4);
  EXPECT_TRUE(sphereProblem(17.0, field.grid()).has_value());
  EXPECT_TRUE(sphereProblem(0.0, field.grid()).has_value());
  EXPECT_TRUE(sphereProblem(NAN, field.grid()).has_value());
  EXPECT_FALSE(sphereProblem(16.0, field.grid()).has_value());
}

TEST(SphereSolve, ProjectionIsTheNearestPointOfTheIntersection) {
  std::mt19937_64 random(3);
  const auto unitVector = [&] {
    return glm::normalize(
        glm::dvec3(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, 0.05, 1)));
  };
  for (int i = 0; i < 3000; ++i) {
    std::array<HalfSpace, 12> h;
    const int n = 1 + i % 12;
    for (int k = 0; k < n; ++k) h[static_cast<std::size_t>(k)] = {unitVector(), -uniform(random, 0, 0.5)};
    const glm::dvec3 goal{uniform(random, -2, 2), uniform(random, -2, 2), uniform(random, -3, 1)};
    const Projection p = projectOnHalfSpaces(goal, h.data(), n, 1e-12);
    ASSERT_TRUE(p.solved);
    // Karush, Kuhn and Tucker: inside all, and y - goal a sum of the normals it rests on, none pulling.
    glm::dvec3 sum = goal;
    for (int k = 0; k < n; ++k)
      EXPECT_GE(glm::dot(h[static_cast<std::size_t>(k)].normal, p.y),
                h[static_cast<std::size_t>(k)].offset - 1e-11);
    for (int k = 0; k < p.count; ++k) {
      const auto j = static_cast<std::size_t>(k);
      EXPECT_GE(p.share[j], 0.0);
      sum += p.share[j] * h[static_cast<std::size_t>(p.active[j])].normal;
      EXPECT_NEAR(glm::dot(h[static_cast<std::size_t>(p.active[j])].normal, p.y),
                  h[static_cast<std::size_t>(p.active[j])].offset, 1e-8);
    }
    EXPECT_NEAR(glm::length(sum - p.y), 0.0, 1e-9);
  }
}

}  // namespace
}  // namespace fettle::haptic
