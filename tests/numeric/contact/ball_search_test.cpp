// The ball's search for contacts, bounded and among what was gathered before, against every cell near, one after
// the other: whole ticks, bit for bit, on every hard field and under edits.
#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/live_field.h"
#include "haptic/contact/certified.h"
#include "haptic/contact/sphere_tip.h"
#include "haptic/scene/scene.h"
#include "haptic/tick/tick.h"
#include "haptic/trials/hand_stroke.h"
#include "tests/haptic/support/fields.h"
#include "tests/numeric/support/hard_fields.h"

namespace fettle::haptic {
namespace {

using tests::HardField;
using tests::Jumps;

// Two balls over one surface; ticks in which they differ in a bit fail.
class TwoBalls {
 public:
  TwoBalls(const engine::Version& field, double radius_mm, int most_steps = kSphereSteps,
           BallMinima minima = BallMinima::kAll, BallSteps steps = BallSteps::kInPlan)
      : surface_(field.reader()),
        bounded_(radius_mm, field.grid(), most_steps, SphereSearch::kBounded, kBallSearches, minima, steps),
        plain_(radius_mm, field.grid(), most_steps, SphereSearch::kCellByCell, kBallSearches, minima, steps) {
  }

  // Whether they agree.
  [[nodiscard]] bool tick(const glm::dvec3& endpoint) {
    const Contact a = bounded_.update(surface_, endpoint, counters_[0]);
    const Contact b = plain_.update(surface_, endpoint, counters_[1]);
    touched_ += a.touching ? 1 : 0;
    most_searches_ = std::max(most_searches_, bounded_.searches());
    const bool same_contact =
        !a.touching ||
        (a.penetration_mm == b.penetration_mm && a.proxy.cell == b.proxy.cell && a.proxy.u == b.proxy.u &&
         a.proxy.v == b.proxy.v && a.proxy.position_mm == b.proxy.position_mm &&
         bounded_.pressed().normal == plain_.pressed().normal);
    return a.touching == b.touching && same_contact && bounded_.centre() == plain_.centre() &&
           bounded_.searches() == plain_.searches() &&
           counters_[0].search_bound_hits == counters_[1].search_bound_hits;
  }
  void refresh(const engine::FieldReader& reader) { surface_.refresh(reader); }

  [[nodiscard]] int touched() const { return touched_; }
  [[nodiscard]] int mostSearches() const { return most_searches_; }

 private:
  Surface surface_;
  SphereTracker bounded_, plain_;
  std::array<TickCounters, 2> counters_;
  int touched_ = 0;
  int most_searches_ = 0;
};

TEST(BallSearch, BoundedOnEveryHardFieldGivesTheBitsOfCellByCell) {
  int touched = 0;
  for (const std::string& name : tests::hardFieldNames()) {
    const HardField hard = tests::hardField(name);
    const engine::Grid& grid = hard.field.grid();
    const double cell = std::min(grid.spacingXMm(), grid.spacingYMm());
    const std::vector<StrokeSample> path = tests::wander(hard, 1200, 31, Jumps::kYes);
    for (const double cells : {0.3, 1.5, 5.0})
      for (const BallSteps steps : {BallSteps::kInPlan, BallSteps::kInSpace}) {
        TwoBalls balls(hard.field, cells * cell, kSphereSteps, BallMinima::kAll, steps);
        for (std::size_t i = 0; i < path.size(); ++i)
          ASSERT_TRUE(balls.tick(path[i].tip_mm)) << name << ", radius " << cells << " cells, tick " << i;
        touched += balls.touched();
      }
  }
  EXPECT_GT(touched, 10'000);
}

constexpr double kSpacing = 0.05;

// The grounds of `fettle bench haptic`, smaller.
std::vector<std::pair<const char*, engine::Version>> benchGrounds() {
  constexpr int kSide = 128;
  const auto ground = [&](auto height) { return tests::fieldOf(kSide, kSide, height, kSpacing, kSpacing); };
  return {
      {"noise", trials::workpiece(kSide, kSpacing)},
      {"clean", trials::workpiece(kSide, kSpacing, 0.0)},
      {"needles", ground([](int c, int r) { return c % 7 == 3 && r % 5 == 2 ? 1e6 : 0.0; })},
      {"twisted cells", ground([](int c, int r) { return (c + r) % 2 == 0 ? -0.25 : 0.25; })},
      {"walls", ground([](int c, int) { return c / 8 % 2 == 0 ? 0.0 : 10.0; })},
      {"pits", ground([](int c, int r) { return (c % 4 == 0 ? -50.0 : 0.0) + (r % 3 == 0 ? -0.05 : 0.0); })},
      {"holes", ground([](int c, int r) {
         return (c * 31 + r * 17) % 37 == 0 ? std::nan("") : 0.02 * ((c * 7 + r * 13) % 11);
       })},
  };
}

// With a hand that also rests.
TEST(BallSearch, BoundedOnRoughPartsNeedlesTwistsWallsAndPitsGivesTheBitsOfCellByCell) {
  for (const auto& [name, field] : benchGrounds()) {
    trials::HandMotion motion;
    motion.ticks = 3000;
    motion.speed_mm_s = 20.0;
    const std::vector<StrokeSample> path = trials::handStroke(field, motion);
    TwoBalls balls(field, 2.0 * kSpacing);
    for (std::size_t i = 0; i < path.size(); ++i) {
      // Each second hundred of ticks at rest.
      const glm::dvec3 at = path[i / 100 % 2 == 0 ? i : i / 100 * 100].tip_mm;
      ASSERT_TRUE(balls.tick(at + glm::dvec3(0.0, 0.0, 2.0 * kSpacing))) << name << ", tick " << i;
    }
    EXPECT_GT(balls.touched(), 1000) << name;
    RecordProperty(std::string("most searches, ") + name, balls.mostSearches());
  }
}

// In space a step tries up to six cuts and twelve halvings, and a bent step twice; a ball that is placed is lifted by halvings
// from needles of 1e6 mm to a tolerance of 5e-8 mm, log2(1e6 / 2.5e-8) = 46 searches. Where nothing holds a ball on its way, the
// endpoint is looked at.
TEST(BallSearch, ATickInSpaceOnNeedlesDoesNotSearchMoreThanItsBoundAndTheStepThatReachesIt) {
  constexpr int kOfOneStep = 6 + 12 + 2;
  constexpr int kOfPlacing = 46 + 3;
  const engine::Version field = tests::fieldOf(
      128, 128, [](int c, int r) { return c % 7 == 3 && r % 5 == 2 ? 1e6 : 0.0; }, kSpacing, kSpacing);
  trials::HandMotion motion;
  motion.ticks = 4000;
  motion.speed_mm_s = 20.0;
  const auto mostOf = [&](int searches) {
    Surface surface(field.reader());
    SphereTracker ball(2.0 * kSpacing, field.grid(), kSphereSteps, SphereSearch::kBounded, searches,
                       BallMinima::kPieces, BallSteps::kInSpace);
    TickCounters counters;
    int most = 0;
    for (const StrokeSample& sample : trials::handStroke(field, motion)) {
      (void)ball.update(surface, sample.tip_mm + glm::dvec3(0.0, 0.0, 2.0 * kSpacing), counters);
      most = std::max(most, ball.searches());
    }
    return most;
  };
  constexpr int kBound = 64;
  const int bounded = mostOf(kBound);
  const int unbounded = mostOf(0);
  std::printf("most searches of a tick on needles: %d bounded, %d without a bound\n", bounded, unbounded);
  EXPECT_LE(bounded, kBound + kOfOneStep + kOfPlacing);
  EXPECT_LE(mostOf(32), 32 + kOfOneStep + kOfPlacing);
  EXPECT_GT(unbounded, kBound + kOfOneStep + kOfPlacing);
}

// In plan the bound also ends a step, but for the first of a tick and for placing a ball: a search where it is, six heights, one
// above all; a bent step twice, two cuts, four on top of what is in the way, four cuts, six quarterings. A search among steep
// cells counts twice, and the last may reach over the bound. Then the endpoint may be looked at, and the ball be placed that an
// edit left inside; nothing is edited here. No tick needs as many: those counted are printed and held.
TEST(BallSearch, ATickInPlanDoesNotSearchMoreThanItsBoundOnAnyGround) {
  constexpr int kOfFirstStep = (8 + 2 + 2 + 4 + 4 + 6) * 2;
  int most_of_all = 0;
  for (const auto& [name, field] : benchGrounds())
    for (const double cells : {0.5, 2.0, 5.0, 16.0}) {
      trials::HandMotion motion;
      motion.ticks = 3000;
      motion.speed_mm_s = 20.0;
      const auto mostOf = [&](int searches) {
        Surface surface(field.reader());
        SphereTracker ball(cells * kSpacing, field.grid(), kSphereSteps, SphereSearch::kBounded, searches);
        TickCounters counters;
        int most = 0;
        for (const StrokeSample& sample : trials::handStroke(field, motion)) {
          (void)ball.update(surface, sample.tip_mm + glm::dvec3(0.0, 0.0, cells * kSpacing), counters);
          most = std::max(most, ball.searches());
        }
        return most;
      };
      EXPECT_LE(mostOf(1), kOfFirstStep + 4) << name << ", radius " << cells;
      most_of_all = std::max(most_of_all, mostOf(kBallSearches));
    }
  std::printf("most searches of a tick on any ground: %d\n", most_of_all);
  EXPECT_GE(most_of_all, kBallSearches);
  EXPECT_LE(most_of_all, kBallSearches + 20);
}

// A ball on a needle 1e6 mm high, whose endpoint goes to the ground beside it. In space it falls a cell per step, so that it
// would need some 3e5 ticks of 64 searches.
TEST(BallSearch, ABallFallsFromANeedleInAFewTicks) {
  const engine::Version field = tests::fieldOf(
      64, 64, [](int c, int r) { return c == 31 && r == 31 ? 1e6 : 0.0; }, kSpacing, kSpacing);
  const double radius = 2.0 * kSpacing;
  const glm::dvec3 top{31.0 * kSpacing, 31.0 * kSpacing, 1e6 + 0.5 * radius};
  const auto heightAfter = [&](BallSteps steps, int ticks) {
    Surface surface(field.reader());
    SphereTracker ball(radius, field.grid(), kSphereSteps, SphereSearch::kBounded, kBallSearches,
                       BallMinima::kAll, steps);
    TickCounters counters;
    EXPECT_TRUE(ball.update(surface, top, counters).touching);
    EXPECT_GT(ball.centre().z, 1e6);
    for (int i = 0; i < ticks; ++i)
      (void)ball.update(surface, {33.0 * kSpacing, 31.3 * kSpacing, 0.5 * radius}, counters);
    return ball.centre().z;
  };
  EXPECT_NEAR(heightAfter(BallSteps::kInPlan, 8), radius, 1e-3);
  EXPECT_GT(heightAfter(BallSteps::kInSpace, 100), 0.9e6);
}

// Ticks with a certified closest point: no ball of the default scene is in the material by more than it states.
TEST(BallSearch, NoBallIsInTheMaterialOnAnyGround) {
  for (const auto& [name, field] : benchGrounds()) {
    if (std::string_view(name) == "needles" || std::string_view(name) == "holes") continue;
    for (const double cells : {0.5, 2.0, 5.0}) {
      const double radius = cells * kSpacing;
      trials::HandMotion motion;
      motion.ticks = 1500;
      motion.speed_mm_s = 50.0;
      Surface surface(field.reader());
      SphereTracker ball(radius, field.grid());
      TickCounters counters;
      double deepest = 0.0;
      for (const StrokeSample& sample : trials::handStroke(field, motion)) {
        (void)ball.update(surface, sample.tip_mm + glm::dvec3(0.0, 0.0, radius), counters);
        SurfacePoint near;
        if (!certifiedClosest(surface, ball.centre(), radius, near)) continue;
        const double in = radius - std::sqrt(near.distance2_mm2);
        deepest = std::max(deepest, in / ball.toleranceMm(ball.centre().z));
      }
      EXPECT_LE(deepest, 1.0 + 1e-6) << name << ", radius " << cells;
      EXPECT_GT(counters.longest_search, 3) << name;
    }
  }
}

// Radii from 2 to 16 cells on needles, moved and at rest: searches that a tick made, and its time, the least of three runs,
// so that other work does not count. A tick at rest does not place a ball.
TEST(BallSearch, ATickAtRestOnNeedlesIsBoundedAtEveryRadius) {
  constexpr std::size_t kRest = 100;  // ticks
  const engine::Version field = tests::fieldOf(
      128, 128, [](int c, int r) { return c % 7 == 3 && r % 5 == 2 ? 1e6 : 0.0; }, kSpacing, kSpacing);
  trials::HandMotion motion;
  motion.ticks = 1000;
  motion.speed_mm_s = 20.0;
  const std::vector<StrokeSample> path = trials::handStroke(field, motion);
  struct Worst {
    int searches = 0;
    double us = 0.0;
  };
  const auto worstOf = [&](double radius_mm, int searches, bool rests) {
    std::vector<double> least_us(path.size(), HUGE_VAL);
    Worst worst;
    for (int run = 0; run < 3; ++run) {
      Surface surface(field.reader());
      SphereTracker ball(radius_mm, field.grid(), kSphereSteps, SphereSearch::kBounded, searches);
      TickCounters counters;
      for (std::size_t i = 0; i < path.size(); ++i) {
        const glm::dvec3& at = path[rests ? i / kRest * kRest : i].tip_mm;
        const auto begin = std::chrono::steady_clock::now();
        (void)ball.update(surface, at + glm::dvec3(0.0, 0.0, radius_mm), counters);
        const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - begin;
        if (rests && i % kRest == 0) continue;  // moved there
        worst.searches = std::max(worst.searches, ball.searches());
        least_us[i] = std::min(least_us[i], took.count());
      }
    }
    for (const double us : least_us)
      if (us < HUGE_VAL) worst.us = std::max(worst.us, us);
    return worst;
  };
  for (const double cells : {2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0}) {
    const Worst rest = worstOf(cells * kSpacing, kBallSearches, true);
    const Worst moved = worstOf(cells * kSpacing, kBallSearches, false);
    const Worst fewer = worstOf(cells * kSpacing, kBallSearches / 2, false);
    std::printf(
        "ball of %2.0f cells on needles, worst tick: at rest %.0f us, %d searches; moved %.0f us, %d; of %d "
        "at most "
        "%.0f us, %d\n",
        cells, rest.us, rest.searches, moved.us, moved.searches, kBallSearches / 2, fewer.us, fewer.searches);
    EXPECT_GT(rest.searches, 0) << cells;
    EXPECT_LE(rest.searches, kBallSearches + 12) << cells;  // a first step among steep cells
    EXPECT_LE(fewer.searches, moved.searches) << cells;
  }
}

// Recordings made before contact revision 3: the hash is that of the ticks at commit 0da33cf, on needles, where 320 searches
// were made in one.
TEST(BallSearch, WithoutABoundTicksHaveTheBitsThatTheyHadBeforeThereWasOne) {
  const engine::Version field = tests::fieldOf(
      128, 128, [](int c, int r) { return c % 7 == 3 && r % 5 == 2 ? 1e6 : 0.0; }, kSpacing, kSpacing);
  trials::HandMotion motion;
  motion.ticks = 4000;
  motion.speed_mm_s = 20.0;
  const auto hashOf = [&](int searches) {
    Scene scene = defaultScene();
    scene.tip = TipShape::kSphere;
    scene.tip_radius_mm = 2.0 * kSpacing;
    scene.ball_searches = searches;
    scene.ball_minima = BallMinima::kPieces;
    scene.ball_steps = BallSteps::kInSpace;
    engine::LiveField live(field, engine::Growth::kAllowed);
    Tick tick(scene, live, field);
    std::uint64_t hash = 0;
    for (StrokeSample sample : trials::handStroke(field, motion)) {
      sample.tip_mm.z += scene.tip_radius_mm;
      const ForceSample felt = tick.run(sample);
      for (const double x :
           {felt.force_n.x, felt.force_n.y, felt.force_n.z, felt.proxy_mm.x, felt.proxy_mm.z})
        hash = std::rotl(hash, 7) ^ std::bit_cast<std::uint64_t>(x);
    }
    return hash;
  };
  constexpr std::uint64_t kBefore = 0x75ac79016260d51eU;
  EXPECT_EQ(hashOf(0), kBefore);
  EXPECT_NE(hashOf(64), kBefore);
}

// Recordings made before contact revision 4: the hashes are those of the ticks at commit f6c9ed2.
TEST(BallSearch, AScenesTextOfRevision3HasTheBitsThatItHadThen) {
  const auto hashOf = [&](const engine::Version& field, int revision, const char* contact) {
    const auto scene = parseScene(std::string("tip = \"sphere\"\ntip_radius_mm = 0.1\n[contact]\n") + contact,
                                  "then", revision);
    EXPECT_TRUE(scene);
    engine::LiveField live(field, engine::Growth::kAllowed);
    Tick tick(*scene, live, field);
    trials::HandMotion motion;
    motion.ticks = 4000;
    motion.speed_mm_s = 20.0;
    std::uint64_t hash = 0;
    for (StrokeSample sample : trials::handStroke(field, motion)) {
      sample.tip_mm.z += scene->tip_radius_mm;
      const ForceSample felt = tick.run(sample);
      for (const double x :
           {felt.force_n.x, felt.force_n.y, felt.force_n.z, felt.proxy_mm.x, felt.proxy_mm.z})
        hash = std::rotl(hash, 7) ^ std::bit_cast<std::uint64_t>(x);
    }
    return hash;
  };
  const auto grounds = benchGrounds();
  const auto check = [&](std::size_t ground, const char* contact, std::uint64_t then) {
    EXPECT_EQ(hashOf(grounds[ground].second, 3, contact), then) << grounds[ground].first << ' ' << contact;
    EXPECT_NE(hashOf(grounds[ground].second, kContactRevision, contact), then) << grounds[ground].first;
  };
  check(0, "", 0x82b8a8057e9fc04bU);
  check(0, "ball_searches = 32\nsearch_rounds = 5", 0x600e2d85b5c70a24U);
  check(2, "ball_minima = \"all\"", 0x1e993e738e53def0U);
  check(6, "", 0xa03473f482f4d926U);
}

engine::Version needlesOf(double height_mm, double spacing_mm) {
  return tests::fieldOf(
      128, 128, [&](int c, int r) { return c % 7 == 3 && r % 5 == 2 ? height_mm : 0.0; }, spacing_mm,
      spacing_mm);
}

// All minima of steep cells, by bounds and cell by cell.
TEST(BallSearch, AllMinimaOfSteepCellsAreTheSameBitsBothWays) {
  const engine::Version field = needlesOf(1e6, kSpacing);
  trials::HandMotion motion;
  motion.ticks = 1000;
  motion.speed_mm_s = 20.0;
  for (const double cells : {1.0, 3.0}) {
    TwoBalls balls(field, cells * kSpacing, kSphereSteps, BallMinima::kAll);
    for (const StrokeSample& sample : trials::handStroke(field, motion))
      ASSERT_TRUE(balls.tick(sample.tip_mm + glm::dvec3(0.0, 0.0, cells * kSpacing))) << "at " << sample.t;
    EXPECT_GT(balls.touched(), 500);
  }
}

// How far balls reach into needles, by the certified closest point: as deep as their radius with pieces, by no more than their
// tolerance, 1e-6 of a cell, and roundings of the heights with all minima. Needles of 1e6 mm are printed alone: where the
// surface rises by 1e6 within 1e-6 of a cell, rounding still hides some.
TEST(BallSearch, WithAllMinimaABallDoesNotEnterANeedle) {
  for (const double height_mm : {10.0, 1e3, 1e6}) {
    const engine::Version field = needlesOf(height_mm, kSpacing);
    trials::HandMotion motion;
    motion.ticks = 2000;
    motion.speed_mm_s = 20.0;
    for (const double cells : {1.0, 2.0, 3.0}) {
      const double radius = cells * kSpacing;
      const double tolerance = 1e-6 * kSpacing + 1e-14 * (height_mm + radius) + 1e-14;
      struct Depth {
        int entered = 0;
        double deepest_mm = 0.0;
      };
      const auto depthOf = [&](BallMinima minima) {
        Surface surface(field.reader());
        SphereTracker ball(radius, field.grid(), kSphereSteps, SphereSearch::kBounded, kBallSearches, minima);
        TickCounters counters;
        Depth depth;
        for (const StrokeSample& sample : trials::handStroke(field, motion)) {
          (void)ball.update(surface, sample.tip_mm + glm::dvec3(0.0, 0.0, radius), counters);
          SurfacePoint near;
          if (!certifiedClosest(surface, ball.centre(), radius, near)) continue;
          const double in = radius - std::sqrt(near.distance2_mm2);
          depth.entered += in > tolerance ? 1 : 0;
          depth.deepest_mm = std::max(depth.deepest_mm, in);
        }
        return depth;
      };
      const Depth pieces = depthOf(BallMinima::kPieces);
      const Depth all = depthOf(BallMinima::kAll);
      std::printf(
          "needles of %.0e mm, ball of %.0f cells: enters in %d of 2000 ticks, by %.1e of its radius; with "
          "all minima in "
          "%d, by %.1e\n",
          height_mm, cells, pieces.entered, pieces.deepest_mm / radius, all.entered, all.deepest_mm / radius);
      if (height_mm < 1e6) {
        EXPECT_EQ(all.entered, 0);
      }
      EXPECT_LE(all.entered, pieces.entered);
      if (height_mm == 1e3) {
        EXPECT_GT(pieces.deepest_mm, 0.1 * radius);
      }
    }
  }
}

// What a ball keeps from tick to tick, and where its window lies, changes nothing: a replay may read the field again at
// other ticks than the loop did.
TEST(BallSearch, ReadingTheFieldAgainAtAnyTickChangesNoBit) {
  for (const auto& [name, field] : benchGrounds())
    for (const double cells : {0.7, 2.0, 6.0})
      for (const BallSteps steps : {BallSteps::kInPlan, BallSteps::kInSpace}) {
        trials::HandMotion motion;
        motion.ticks = 1500;
        motion.speed_mm_s = 20.0;
        Surface kept(field.reader());
        Surface again(field.reader());
        SphereTracker a(cells * kSpacing, field.grid(), kSphereSteps, SphereSearch::kBounded, kBallSearches,
                        BallMinima::kAll, steps);
        SphereTracker b = a;
        TickCounters counters;
        std::mt19937_64 random(5);
        for (const StrokeSample& sample : trials::handStroke(field, motion)) {
          if (random() % 3 == 0) again.refresh(field.reader());
          const glm::dvec3 at = sample.tip_mm + glm::dvec3(0.0, 0.0, cells * kSpacing);
          const Contact x = a.update(kept, at, counters);
          const Contact y = b.update(again, at, counters);
          ASSERT_EQ(x.touching, y.touching) << name << ' ' << cells << " at " << sample.t;
          ASSERT_EQ(a.centre(), b.centre()) << name << ' ' << cells << " at " << sample.t;
          if (x.touching) {
            ASSERT_EQ(x.proxy.position_mm, y.proxy.position_mm) << name << ' ' << cells;
          }
        }
      }
}

TEST(BallSearch, BoundedUnderEditsGivesTheBitsOfCellByCell) {
  const engine::Version field = trials::workpiece(128, kSpacing);
  engine::LiveField live(field, engine::Growth::kAllowed);
  TwoBalls balls(field, 2.0 * kSpacing);
  trials::HandMotion motion;
  motion.ticks = 3000;
  motion.speed_mm_s = 5.0;
  std::mt19937_64 random(8);
  for (const StrokeSample& sample : trials::handStroke(field, motion)) {
    const auto column = static_cast<std::int32_t>(sample.tip_mm.x / kSpacing);
    const auto row = static_cast<std::int32_t>(sample.tip_mm.y / kSpacing);
    if (random() % 3 == 0 && column >= 0 && row >= 0 && column < 128 && row < 128) {
      const float z = random() % 50 == 0 ? NAN : static_cast<float>(tests::uniform(random, -0.05, 0.05));
      ASSERT_TRUE(live.setHeight(column, row, z));
      balls.refresh(live.reader());
    }
    ASSERT_TRUE(balls.tick(sample.tip_mm + glm::dvec3(0.0, 0.0, 2.0 * kSpacing))) << "at " << sample.t;
  }
  EXPECT_GT(balls.touched(), 1500);
}

}  // namespace
}  // namespace fettle::haptic
