// What a ball's tick may look at among steep cells: bounded, and the ball still arrives, stays out of the material and gets free.
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "haptic/contact/certified.h"
#include "haptic/contact/sphere_tip.h"
#include "haptic/trials/hand_stroke.h"
#include "tests/haptic/support/fields.h"

namespace fettle::haptic {
namespace {

constexpr double kWorkSpacing = 0.05;
constexpr int kWorkSide = 128;

struct Spiky {
  const char* name;
  engine::Version field;
  double top_mm;  // nothing is higher
};

std::vector<Spiky> spikyGrounds() {
  const auto ground = [&](auto height) {
    return tests::fieldOf(kWorkSide, kWorkSide, height, kWorkSpacing, kWorkSpacing);
  };
  std::mt19937_64 random(11);
  return {
      {"needles 2 x 2", ground([](int c, int r) { return c % 2 == 1 && r % 2 == 1 ? 1e3 : 0.0; }), 1e3},
      {"needles 3 x 3", ground([](int c, int r) { return c % 3 == 1 && r % 3 == 1 ? 1e3 : 0.0; }), 1e3},
      {"spikes 3 %", ground([&](int, int) {
         return tests::uniform(random, 0.0, 1.0) < 0.03 ? 5.0 : 0.02 * tests::uniform(random, -2.0, 2.0);
       }),
       5.0},
      {"white", ground([&](int, int) { return tests::uniform(random, -1e3, 1e3); }), 1e3},
      {"checkerboard", ground([](int c, int r) { return (c + r) % 2 == 0 ? 1e3 : 0.0; }), 1e3},
  };
}

SphereTracker ballOf(double cells, const Spiky& ground, int work,
                     SphereSearch search = SphereSearch::kBounded) {
  return {cells * kWorkSpacing, ground.field.grid(), kSphereSteps,       search,
          kBallSearches,        BallMinima::kAll,    BallSteps::kInPlan, work};
}

// How far a centre is in the material.
double depthOf(Surface& surface, const SphereTracker& ball, double radius_mm) {
  SurfacePoint near;
  if (!certifiedClosest(surface, ball.centre(), radius_mm, near)) return 0.0;
  return radius_mm - std::sqrt(near.distance2_mm2);
}

// A hand that goes down on the ground anywhere, deep or by a little, and stays there.
TEST(BallWork, ABallArrivesStaysOutOfTheMaterialAndIsFreeAtOnceWhenItIsPulledOut) {
  constexpr int kWay = 30;
  constexpr int kAtRest = 150;
  for (const Spiky& ground : spikyGrounds())
    for (const double cells : {6.0, 16.0})
      for (const int work : {kBallWork, 1}) {
        const double radius = cells * kWorkSpacing;
        std::mt19937_64 random(3);
        double distance = 0.0, without = 0.0;
        for (int hand = 0; hand < 8; ++hand) {
          Surface surface(ground.field.reader());
          SphereTracker ball = ballOf(cells, ground, work);
          SphereTracker unbounded = ballOf(cells, ground, 0);
          TickCounters counters;
          const auto at = [&](double z) {
            return glm::dvec3(tests::uniform(random, 1.5, 5.0), tests::uniform(random, 1.5, 5.0), z);
          };
          const glm::dvec3 from = at(ground.top_mm + 2.0 * radius);
          const glm::dvec3 to = at(hand % 2 == 0 ? -0.1 : ground.top_mm - 0.1);
          const double tolerance = 1e-6 * kWorkSpacing + 1e-14 * (ground.top_mm + radius) + 1e-14;
          bool touches = false;
          const auto tick = [&](const glm::dvec3& endpoint) {
            touches = unbounded.update(surface, endpoint, counters).touching;
            const Contact contact = ball.update(surface, endpoint, counters);
            EXPECT_LE(depthOf(surface, ball, radius), tolerance)
                << ground.name << ' ' << cells << ' ' << work;
            return contact;
          };
          for (int i = 0; i <= kWay; ++i) static_cast<void>(tick(from + (to - from) * (i / double{kWay})));
          for (int i = 0; i < kAtRest; ++i) {
            const bool touching = tick(to).touching;
            EXPECT_EQ(touching, touches) << ground.name << ' ' << cells << ' ' << work;
          }
          // At rest but for roundings of the height; with the least work, at rest or on its way.
          const glm::dvec3 rest = ball.centre();
          for (int i = 0; i < 20; ++i) static_cast<void>(tick(to));
          const double moved = work == kBallWork ? glm::length(ball.centre() - rest)
                                                 : glm::length(ball.centre() - to) - glm::length(rest - to);
          EXPECT_LE(moved, 1e-4 * kWorkSpacing + 1e-9 * ground.top_mm)
              << ground.name << ' ' << cells << ' ' << work << ' ' << hand;
          distance += glm::length(ball.centre() - to);
          without += glm::length(unbounded.centre() - to);
          glm::dvec3 out = to;
          out.x += 0.3;
          out.z = ground.top_mm + 1.01 * radius;
          EXPECT_FALSE(tick(out).touching) << ground.name << ' ' << cells << ' ' << work;
          EXPECT_EQ(ball.centre(), out) << ground.name << ' ' << cells << ' ' << work;
        }
        if (work == kBallWork) {
          EXPECT_LE(distance, 1.001 * without) << ground.name << ' ' << cells;
        }
      }
}

// Without the bound a search deep among needles looks at several hundred.
TEST(BallWork, ATickLooksAtNoMoreSteepCellsThanItsBoundAndItsLastSearch) {
  constexpr int kOfOneSearch = 40;
  for (const Spiky& ground : spikyGrounds())
    for (const double cells : {2.0, 6.0, 16.0}) {
      Surface surface(ground.field.reader());
      SphereTracker ball = ballOf(cells, ground, kBallWork);
      TickCounters counters;
      trials::HandMotion motion;
      motion.ticks = 1500;
      motion.speed_mm_s = 20.0;
      int most = 0;
      for (const StrokeSample& sample : trials::handStroke(ground.field, motion)) {
        static_cast<void>(
            ball.update(surface, sample.tip_mm + glm::dvec3(0.0, 0.0, cells * kWorkSpacing), counters));
        most = std::max(most, ball.work());
      }
      EXPECT_GT(most, 0) << ground.name << ' ' << cells;
      EXPECT_LE(most, kBallWork + kOfOneSearch) << ground.name << ' ' << cells;
    }
}

// The work is that of the field around each place: however it is searched, and whatever was kept from tick to tick.
TEST(BallWork, IsTheSameCellByCellAndWhenTheFieldIsReadAgain) {
  for (const Spiky& ground : spikyGrounds())
    for (const double cells : {6.0, 16.0})
      for (const int work : {kBallWork, 7}) {
        Surface kept(ground.field.reader());
        Surface again(ground.field.reader());
        SphereTracker bounded = ballOf(cells, ground, work);
        SphereTracker read_again = ballOf(cells, ground, work);
        SphereTracker plain = ballOf(cells, ground, work, SphereSearch::kCellByCell);
        TickCounters counters;
        trials::HandMotion motion;
        motion.ticks = 200;
        motion.speed_mm_s = 20.0;
        std::mt19937_64 random(5);
        for (const StrokeSample& sample : trials::handStroke(ground.field, motion)) {
          const glm::dvec3 at = sample.tip_mm + glm::dvec3(0.0, 0.0, cells * kWorkSpacing);
          if (random() % 3 == 0) again.refresh(ground.field.reader());
          static_cast<void>(bounded.update(kept, at, counters));
          static_cast<void>(plain.update(kept, at, counters));
          static_cast<void>(read_again.update(again, at, counters));
          ASSERT_EQ(bounded.centre(), plain.centre()) << ground.name << ' ' << cells << " at " << sample.t;
          ASSERT_EQ(bounded.work(), plain.work()) << ground.name << ' ' << cells << " at " << sample.t;
          ASSERT_EQ(bounded.centre(), read_again.centre())
              << ground.name << ' ' << cells << " at " << sample.t;
        }
      }
}

// A ball of two cells does not come to its bound among needles, nor where no cell is steep.
TEST(BallWork, ABallOfTwoCellsOnNoiseNeedlesAndWallsIsAsWithoutABound) {
  const auto ground = [&](auto height) {
    return tests::fieldOf(kWorkSide, kWorkSide, height, kWorkSpacing, kWorkSpacing);
  };
  const std::pair<const char*, engine::Version> grounds[] = {
      {"noise", trials::workpiece(kWorkSide, kWorkSpacing)},
      {"needles", ground([](int c, int r) { return c % 7 == 3 && r % 5 == 2 ? 1e6 : 0.0; })},
      {"twisted cells", ground([](int c, int r) { return (c + r) % 2 == 0 ? -0.25 : 0.25; })},
      {"walls", ground([](int c, int) { return c / 8 % 2 == 0 ? 0.0 : 10.0; })},
      {"pits", ground([](int c, int r) { return (c % 4 == 0 ? -50.0 : 0.0) + (r % 3 == 0 ? -0.05 : 0.0); })},
  };
  for (const auto& [name, field] : grounds) {
    Surface surface(field.reader());
    SphereTracker bounded = ballOf(2.0, {name, field, 0.0}, kBallWork);
    SphereTracker unbounded = ballOf(2.0, {name, field, 0.0}, 0);
    TickCounters counters;
    trials::HandMotion motion;
    motion.ticks = 4000;
    motion.speed_mm_s = 20.0;
    for (const StrokeSample& sample : trials::handStroke(field, motion)) {
      const glm::dvec3 at = sample.tip_mm + glm::dvec3(0.0, 0.0, 2.0 * kWorkSpacing);
      const Contact a = bounded.update(surface, at, counters);
      const Contact b = unbounded.update(surface, at, counters);
      ASSERT_EQ(a.touching, b.touching) << name << " at " << sample.t;
      ASSERT_EQ(bounded.centre(), unbounded.centre()) << name << " at " << sample.t;
    }
  }
}

}  // namespace
}  // namespace fettle::haptic
