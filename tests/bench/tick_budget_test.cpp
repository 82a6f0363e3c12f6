// What a tick may cost, in instructions: the same on an idle machine and on a busy one, so that a change that
// makes it dearer fails here and not in somebody's hand. Of a release build alone: other builds have other
// instructions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "bench/accuracy/subjects.h"
#include "bench/instructions.h"
#include "bench/least_ball.h"
#include "bench/least_search.h"
#include "engine/base/stopwatch.h"
#include "engine/field/builder.h"
#include "engine/field/live_field.h"
#include "haptic/base/rt_thread.h"
#include "haptic/contact/sphere_tip.h"
#include "haptic/scene/scene.h"
#include "haptic/tick/tick.h"
#include "haptic/trials/hand_stroke.h"

namespace fettle::bench {
namespace {

constexpr double kSpacingMm = 0.05;
#if defined(NDEBUG) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
constexpr bool kReleased = true;
#else
constexpr bool kReleased = false;
#endif

struct Budget {
  const char* name;
  haptic::Tool tool;
  haptic::ContactLevel level;
  double ball_cells;  // 0: a point
  int counted;        // ticks
  // Instructions a tick as counted when this was written, with the compiler of Debian 12. A tenth more fails;
  // so does a quarter less, to be written down here and defended from then on.
  double instructions;
};

constexpr Budget kBudgets[] = {
    {"feel", haptic::Tool::kFeel, haptic::ContactLevel::kPaper, 0.0, 200, 2444.0},
    {"descent", haptic::Tool::kFeel, haptic::ContactLevel::kDescent, 0.0, 200, 1366.0},
    {"3 x 3 smoothing", haptic::Tool::kSmooth, haptic::ContactLevel::kPaper, 0.0, 200, 2906.0},
    {"certified, 2 cells", haptic::Tool::kFeel, haptic::ContactLevel::kCertified, 0.0, 40, 8075.0},
    {"ball, 2 cells", haptic::Tool::kFeel, haptic::ContactLevel::kPaper, 2.0, 12, 26219.0},
};

// Ticks spread over a hand's way: each counted one follows on its predecessor, as the rest do.
std::optional<double> instructionsOf(const Budget& budget) {
  const engine::Version field = trials::workpiece(256, kSpacingMm);
  trials::HandMotion motion;
  motion.ticks = 20'000;
  motion.speed_mm_s = 20.0;
  motion.tool = budget.tool;
  std::vector<haptic::StrokeSample> strokes = trials::handStroke(field, motion);
  haptic::Scene scene = haptic::defaultScene();
  scene.level = budget.level;
  if (budget.ball_cells > 0.0) {
    scene.tip = haptic::TipShape::kSphere;
    scene.tip_radius_mm = budget.ball_cells * kSpacingMm;
    for (haptic::StrokeSample& s : strokes) s.tip_mm.z += scene.tip_radius_mm;
  }
  engine::LiveField live(field, engine::Growth::kAllowed);
  haptic::Tick tick(scene, live, field);
  const haptic::DenormalScope as_in_the_loop;
  const std::size_t begin = strokes.size() / 2;
  for (std::size_t i = 0; i < begin; ++i) (void)tick.run(strokes[i]);
  const auto count = countInstructions([&] {
    for (int i = 0; i < budget.counted; ++i) (void)tick.run(strokes[begin + static_cast<std::size_t>(i)]);
  });
  if (!count.instructions) return std::nullopt;
  return static_cast<double>(*count.instructions) / budget.counted;
}

class TickBudget : public testing::TestWithParam<Budget> {};

TEST_P(TickBudget, IsKept) {
  if (!kReleased) GTEST_SKIP() << "not a release build";
  const Budget& budget = GetParam();
  const auto counted = instructionsOf(budget);
  if (!counted) GTEST_SKIP() << "instructions cannot be counted here";
  RecordProperty("instructions_a_tick", static_cast<int>(*counted));
  EXPECT_LE(*counted, 1.1 * budget.instructions) << budget.name << ": dearer than it was";
  EXPECT_GE(*counted, 0.75 * budget.instructions) << budget.name << ": cheaper; write the new figure down";
}

// The longest tick of a ball, of 10,000 on the grounds of `fettle bench haptic`: 2 cells in radius, 8 cells on noise whose holes are
// samples of 3.4e38, as of a file that does not declare its no-data value, and 16 cells, the largest, on needles and spikes. The
// longest in instructions of the tick that searches most and of those that take longest by the clock: several are about as long, so
// that other work on the machine does not decide. Large balls: of 3,000 ticks, that of the clock alone, since a tick is counted
// step by step; on the rest of the spiky grounds it is not counted. Not with the first ten ticks, which load windows into the cache.
struct Longest {
  const char* ground;
  float (*height)(std::int32_t column, std::int32_t row) noexcept;  // nullptr: the rough part
  double instructions;                                              // 0: printed by the clock alone
  double radius_cells = 2.0;
};

constexpr Longest kLongest[] = {
    {"rough part", nullptr, 146'049.0},
    {"needles",
     [](std::int32_t c, std::int32_t r) noexcept { return c % 7 == 3 && r % 5 == 2 ? 1e6F : 0.0F; },
     200'034.0},
    {"twisted cells",
     [](std::int32_t c, std::int32_t r) noexcept { return (c + r) % 2 == 0 ? -0.25F : 0.25F; }, 205'813.0},
    {"walls", [](std::int32_t c, std::int32_t) noexcept { return c / 8 % 2 == 0 ? 0.0F : 10.0F; }, 81'893.0},
    {"pits",
     [](std::int32_t c, std::int32_t r) noexcept {
       return (c % 4 == 0 ? -50.0F : 0.0F) + (r % 3 == 0 ? -0.05F : 0.0F);
     },
     86'191.0},
    {"needles, largest ball",
     [](std::int32_t c, std::int32_t r) noexcept { return c % 7 == 3 && r % 5 == 2 ? 1e6F : 0.0F; },
     572'024.0, 16.0},
    {"needles 3 x 3, largest ball",
     [](std::int32_t c, std::int32_t r) noexcept { return c % 3 == 1 && r % 3 == 1 ? 1e6F : 0.0F; }, 0.0,
     16.0},
    {"needles 3 x 3, 4 cells",
     [](std::int32_t c, std::int32_t r) noexcept { return c % 3 == 1 && r % 3 == 1 ? 1e6F : 0.0F; }, 0.0,
     4.0},
    {"needles 2 x 2, largest ball",
     [](std::int32_t c, std::int32_t r) noexcept { return c % 2 == 1 && r % 2 == 1 ? 1e6F : 0.0F; },
     428'489.0, 16.0},
    {"needles of 10 mm, largest ball",
     [](std::int32_t c, std::int32_t r) noexcept { return c % 4 == 1 && r % 4 == 1 ? 10.0F : 0.0F; }, 0.0,
     16.0},
    {"spikes 3 %, largest ball",
     [](std::int32_t c, std::int32_t r) noexcept {
       return whiteNoise(5, c, r) > 1.88F ? 5.0F : static_cast<float>(0.02 * whiteNoise(6, c, r));
     },
     682'054.0, 16.0},
    {"needles 10 %, largest ball",
     [](std::int32_t c, std::int32_t r) noexcept {
       return whiteNoise(5, c, r) > 1.28F ? 1e6F : static_cast<float>(0.02 * whiteNoise(6, c, r));
     },
     0.0, 16.0},
    {"white, largest ball",
     [](std::int32_t c, std::int32_t r) noexcept { return static_cast<float>(1e3 * whiteNoise(5, c, r)); },
     0.0, 16.0},
    {"checkerboard", [](std::int32_t c, std::int32_t r) noexcept { return (c + r) % 2 != 0 ? 1e6F : 0.0F; },
     0.0},
    {"checkerboard, largest ball",
     [](std::int32_t c, std::int32_t r) noexcept { return (c + r) % 2 != 0 ? 1e6F : 0.0F; }, 0.0, 16.0},
    {"undeclared holes",
     [](std::int32_t c, std::int32_t r) noexcept {
       const auto drawn = [&](std::uint64_t seed) { return static_cast<float>(whiteNoise(seed, c, r)); };
       return drawn(2) > 1.9F ? std::numeric_limits<float>::max() : 0.02F * drawn(1);
     },
     492'478.0, 8.0},
};

class LongestTick : public testing::TestWithParam<Longest> {};

TEST_P(LongestTick, OfABallKeepsItsBudget) {
  if (!kReleased) GTEST_SKIP() << "not a release build";
  const Longest& ground = GetParam();
  constexpr std::int32_t kSide = 256;
  const double radius_mm = ground.radius_cells * kSpacingMm;
  const engine::Version field = [&] {
    if (ground.height == nullptr) return trials::workpiece(kSide, kSpacingMm);
    engine::Grid grid;
    grid.width = grid.height = kSide;
    grid.spacing_x = grid.spacing_y = kSpacingMm;
    std::vector<float> z;
    for (std::int32_t r = 0; r < kSide; ++r)
      for (std::int32_t c = 0; c < kSide; ++c) z.push_back(ground.height(c, r));
    return engine::makeField(grid, z);
  }();
  trials::HandMotion motion;
  motion.ticks = 10'000;
  motion.speed_mm_s = 20.0;
  std::vector<haptic::StrokeSample> strokes = trials::handStroke(field, motion);
  const bool large = ground.radius_cells > 2.0 || std::string(ground.ground) == "checkerboard";
  if (large) strokes.resize(3'000);
  for (haptic::StrokeSample& s : strokes) s.tip_mm.z += radius_mm;
  const haptic::DenormalScope as_in_the_loop;
  std::vector<double> least_ns(strokes.size(), std::numeric_limits<double>::infinity());
  std::vector<int> searches(strokes.size());
  std::vector<int> work(strokes.size());
  // Of so many passes one is not held up by other work, in each tick: three were too few on a busy machine.
  const int passes = large ? 8 : 20;
  for (int pass = 0; pass < passes; ++pass) {
    haptic::Surface surface(field.reader());
    haptic::SphereTracker ball(radius_mm, field.grid());
    haptic::TickCounters counters;
    for (std::size_t i = 0; i < strokes.size(); ++i) {
      const engine::Stopwatch watch;
      static_cast<void>(ball.update(surface, strokes[i].tip_mm, counters));
      least_ns[i] = std::min(least_ns[i], watch.ns());
      searches[i] = ball.searches();
      work[i] = ball.work();
    }
  }
  if (ground.instructions == 0.0) {
    const auto longest = std::max_element(least_ns.begin() + 10, least_ns.end());
    std::printf("%s: tick %td, %.1f us, at most %d steep cells\n", ground.ground, longest - least_ns.begin(),
                1e-3 * *longest, *std::max_element(work.begin(), work.end()));
    EXPECT_LE(*std::max_element(work.begin(), work.end()), haptic::kBallWork + 40);
    return;
  }
  const std::size_t candidates = large ? 1 : 3;
  std::vector<std::size_t> order(strokes.size() - 10);
  std::iota(order.begin(), order.end(), std::size_t{10});
  const std::ptrdiff_t by_searches = large ? 0 : 1;
  if (!large)
    std::swap(order.front(), *std::max_element(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
                return searches[a] < searches[b];
              }));
  std::partial_sort(order.begin() + by_searches, order.begin() + static_cast<std::ptrdiff_t>(candidates),
                    order.end(), [&](std::size_t a, std::size_t b) { return least_ns[a] > least_ns[b]; });
  order.resize(candidates);
  std::sort(order.begin(), order.end());
  // One after the other, by one ball: what is counted is lost with the copy that it is counted in, and is played after it.
  haptic::Surface surface(field.reader());
  haptic::SphereTracker ball(radius_mm, field.grid());
  haptic::TickCounters counters;
  std::size_t next = 0;
  std::size_t longest = 0;
  double counted = 0.0;
  for (const std::size_t at : order) {
    for (; next < at; ++next) static_cast<void>(ball.update(surface, strokes[next].tip_mm, counters));
    // Both ways of counting begin where the ball is now.
    haptic::SphereTracker ball_here = ball;
    const auto count = countInstructions(
        [&] { static_cast<void>(ball_here.update(surface, strokes[at].tip_mm, counters)); });
    if (!count.instructions) GTEST_SKIP() << "instructions cannot be counted here";
    if (static_cast<double>(*count.instructions) <= counted) continue;
    counted = static_cast<double>(*count.instructions);
    longest = at;
  }
  std::printf("%s: tick %zu, %.0f instructions, %.1f us\n", ground.ground, longest, counted,
              1e-3 * least_ns[longest]);
  RecordProperty("instructions", static_cast<int>(counted));
  EXPECT_LE(counted, 1.1 * ground.instructions) << ground.ground << ": dearer than it was";
  EXPECT_GE(counted, 0.75 * ground.instructions) << ground.ground << ": cheaper; write the new figure down";
}

INSTANTIATE_TEST_SUITE_P(Grounds, LongestTick, testing::ValuesIn(kLongest), [](const auto& tried) {
  std::string name;
  for (const char c : std::string(tried.param.ground))
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) name += c;
  return name;
});

// The same ticks of level paper beside what they cannot do without.
TEST(LeastOfATick, OfLevelPaperIsBesideTheLeastThatItsSearchNeeds) {
  if (!kReleased) GTEST_SKIP() << "not a release build";
  const engine::Version field = trials::workpiece(256, kSpacingMm);
  trials::HandMotion motion;
  motion.ticks = 20'000;
  motion.speed_mm_s = 20.0;
  const std::vector<haptic::StrokeSample> strokes = trials::handStroke(field, motion);
  const LeastSearch least(field, std::span(strokes).subspan(strokes.size() / 2, 200));
  EXPECT_NE(least.run(), 0.0);
  const auto count = countInstructions([&] { static_cast<void>(least.run()); });
  if (!count.instructions) GTEST_SKIP() << "instructions cannot be counted here";
  const double each = static_cast<double>(*count.instructions) / static_cast<double>(least.contacts());
  std::printf(
      "least of a contact: %.0f instructions, %.2f cells, %.2f of them by Newton's method, %.0f bytes\n",
      each, least.cells(), least.newtonCells(), least.bytes());
  EXPECT_GT(least.contacts(), 190);
  // Four edges and their comparison take some 100.
  EXPECT_GT(each, 100.0 * least.cells());
  EXPECT_LT(each, kBudgets[0].instructions);
}

TEST(LeastOfATick, OfABallIsBesideTheLeastThatItsContactsNeed) {
  if (!kReleased) GTEST_SKIP() << "not a release build";
  const engine::Version field = trials::workpiece(256, kSpacingMm);
  const double radius_mm = 2.0 * kSpacingMm;
  trials::HandMotion motion;
  motion.ticks = 20'000;
  motion.speed_mm_s = 20.0;
  std::vector<haptic::StrokeSample> strokes = trials::handStroke(field, motion);
  for (haptic::StrokeSample& s : strokes) s.tip_mm.z += radius_mm;
  const LeastBall least(field, radius_mm, std::span(strokes).subspan(strokes.size() / 2, 60));
  EXPECT_NE(least.run(), 0.0);
  // Most ticks' places lead to where the ball went: else the least would be that of its last steps alone.
  EXPECT_LT(least.shareOfEndsAlone(), 0.25);
  EXPECT_GT(least.steps(), 1.5);
  const auto count = countInstructions([&] { static_cast<void>(least.run()); });
  if (!count.instructions) GTEST_SKIP() << "instructions cannot be counted here";
  const double each = static_cast<double>(*count.instructions) / static_cast<double>(least.contacts());
  std::printf(
      "least of a ball: %.0f instructions, %.2f steps, %.2f places, %.2f of them insides, %.0f bytes\n", each,
      least.steps(), least.cells(), least.newtonCells(), least.bytes());
  EXPECT_GT(least.contacts(), 50);
  // A place's point, distance and half-space take some 100.
  EXPECT_GT(each, 100.0 * least.cells());
  EXPECT_LT(each, kBudgets[4].instructions);
}

INSTANTIATE_TEST_SUITE_P(Ways, TickBudget, testing::ValuesIn(kBudgets), [](const auto& tried) {
  std::string name;
  for (const char c : std::string(tried.param.name))
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) name += c;
  return name;
});

}  // namespace
}  // namespace fettle::bench
