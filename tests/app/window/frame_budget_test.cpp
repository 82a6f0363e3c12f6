#include "app/window/frame_budget.h"
#include "app/window/sharp_later.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

// Frames of so many milliseconds until the decision is another; 0: it stays.
int framesUntilChange(FrameBudget& budget, double ms, int most = 1000) {
  const bool before = budget.less();
  for (int i = 1; i <= most; ++i) {
    budget.note(ms);
    if (budget.less() != before) return i;
  }
  return 0;
}

TEST(FrameBudget, DrawsAllWhileFramesAreQuickEnough) {
  FrameBudget budget;
  EXPECT_FALSE(budget.less());
  EXPECT_EQ(framesUntilChange(budget, FrameBudget::kSlow_ms), 0);
}

TEST(FrameBudget, DrawsLessAfterAFewSlowFrames) {
  FrameBudget budget;
  EXPECT_EQ(framesUntilChange(budget, 26.0), FrameBudget::kFew);
  FrameBudget after_quick_ones;
  for (int i = 0; i < 50; ++i) after_quick_ones.note(12.0);
  // 12 + 28 (1 - 0.75^n) > 25 at n = 3.
  EXPECT_EQ(framesUntilChange(after_quick_ones, 40.0), 3);
}

TEST(FrameBudget, HasItsOwnLimitsForWholeFrames) {
  const FrameBudget fresh{FrameBudget::kSlowWhole_ms, FrameBudget::kQuickWhole_ms, FrameBudget::kFewWhole};
  FrameBudget whole = fresh;
  EXPECT_EQ(framesUntilChange(whole, 32.0), 0);
  // Among quick ones a single long frame changes nothing.
  FrameBudget once = fresh;
  for (int i = 0; i < 10; ++i) once.note(20.0);
  once.note(900.0);
  EXPECT_FALSE(once.less());
  EXPECT_EQ(framesUntilChange(once, 20.0), 0);
  // Not the first one of all, either, where it is longer by far.
  FrameBudget compiled = fresh;
  compiled.note(3.1 * FrameBudget::kSlowWhole_ms);
  EXPECT_FALSE(compiled.less());
  EXPECT_EQ(framesUntilChange(compiled, 20.0), 0);
  FrameBudget slow = fresh;
  EXPECT_EQ(framesUntilChange(slow, 3.1 * FrameBudget::kSlowWhole_ms), 2);
  // One that is slow decides, also among quick ones.
  FrameBudget among = fresh;
  for (int i = 0; i < 10; ++i) among.note(15.0);
  EXPECT_EQ(framesUntilChange(among, 40.0), 1);
  whole = fresh;
  EXPECT_EQ(framesUntilChange(whole, 80.0), 1);
  EXPECT_TRUE(whole.less());
  EXPECT_EQ(framesUntilChange(whole, 17.0, 200), 0);
  EXPECT_GE(framesUntilChange(whole, 15.0), FrameBudget::kCalm);
}

// The first key of all must not wait for a frame of which nobody knows how long it takes.
TEST(FrameBudget, AssumesThatWholeFramesAreSlow) {
  FrameBudget unknown = FrameBudget::ofWhole();
  EXPECT_TRUE(unknown.less());
  EXPECT_FALSE(unknown.known());
  // A few quick ones with less show that there is time; where there is none, the first one with all does.
  EXPECT_EQ(framesUntilChange(unknown, 1.0), FrameBudget::kFew);
  EXPECT_TRUE(unknown.known());
  EXPECT_EQ(framesUntilChange(unknown, 80.0), 1);
  EXPECT_EQ(unknown.calm(), FrameBudget::kCalm);
  EXPECT_EQ(framesUntilChange(unknown, 17.0, 200), 0);
  // One of them in which something was compiled does not count.
  FrameBudget compiled = FrameBudget::ofWhole();
  compiled.note(200.0);
  EXPECT_EQ(framesUntilChange(compiled, 1.0), FrameBudget::kFew);
}

TEST(FrameBudget, IsToldHowLongFramesTakeWhileItAssumes) {
  const auto told = [](double at_least_ms, double at_most_ms) {
    FrameBudget budget = FrameBudget::ofWhole();
    budget.note(20.0);
    budget.tell(at_least_ms, at_most_ms);
    return std::pair(budget.known(), budget.less());
  };
  EXPECT_EQ(told(20.0, 20.0), std::pair(true, false));
  EXPECT_EQ(told(0.0, 33.0), std::pair(true, false));  // some of it was uploading
  EXPECT_EQ(told(0.0, 60.0), std::pair(false, true));
  EXPECT_EQ(told(30.0, 60.0), std::pair(false, true));  // a half of it
  EXPECT_EQ(told(40.0, 40.0), std::pair(true, true));
  EXPECT_EQ(told(133.0, 133.0), std::pair(false, true));  // compiled
  // What was measured is not told otherwise.
  FrameBudget known = FrameBudget::ofWhole();
  known.tell(40.0, 40.0);
  known.tell(1.0, 1.0);
  EXPECT_TRUE(known.less());
  EXPECT_EQ(framesUntilChange(known, 1.0), FrameBudget::kCalm);
}

TEST(SharpLater, IsDueOnceNothingHasChangedForAWhile) {
  using namespace std::chrono_literals;
  SharpLater later;
  const SharpLater::Clock::time_point begin{};
  EXPECT_FALSE(later.pending());
  EXPECT_FALSE(later.due(begin + 10s));
  later.drawnWithLess(begin);
  later.drawnWithLess(begin + 100ms);
  EXPECT_TRUE(later.pending());
  EXPECT_FALSE(later.due(begin + 100ms + SharpLater::kQuiet - 1ms));
  EXPECT_TRUE(later.due(begin + 100ms + SharpLater::kQuiet));
  later.drawnSharply();
  EXPECT_FALSE(later.due(begin + 10s));
}

TEST(FrameBudget, HasItsOwnLimitsForStrokes) {
  FrameBudget strokes{FrameBudget::kSlowStroke_ms, FrameBudget::kQuickStroke_ms};
  EXPECT_EQ(framesUntilChange(strokes, 9.0), 0);
  EXPECT_GT(framesUntilChange(strokes, 11.5), 0);
  EXPECT_TRUE(strokes.less());
  EXPECT_EQ(framesUntilChange(strokes, 5.0), 0) << "no time for what is left out";
  EXPECT_GE(framesUntilChange(strokes, 3.0), FrameBudget::kCalm);
}

TEST(FrameBudget, ASingleLongFrameChangesNothing) {
  FrameBudget budget;
  for (int i = 0; i < 10; ++i) budget.note(14.0);
  budget.note(900.0);
  EXPECT_FALSE(budget.less());
  EXPECT_EQ(framesUntilChange(budget, 14.0), 0);
}

// The first one of all compiles more than any other.
TEST(FrameBudget, ASingleLongFrameChangesNothingWhereverItComes) {
  for (const int before : {0, 1, 2, 20})
    for (const double usual : {5.0, 20.0}) {
      FrameBudget budget;
      for (int i = 0; i < before; ++i) budget.note(usual);
      budget.note(900.0);
      EXPECT_FALSE(budget.less()) << before;
      EXPECT_EQ(framesUntilChange(budget, usual), 0) << before << " frames of " << usual;
    }
}

TEST(FrameBudget, DrawsAllAgainAfterQuickFramesInARow) {
  FrameBudget budget;
  (void)framesUntilChange(budget, 40.0);
  ASSERT_TRUE(budget.less());
  // Quick enough for less, but not with time to spare.
  EXPECT_EQ(framesUntilChange(budget, 20.0), 0);
  // The mean falls below 12 at the fifth frame of 9: 9 + 11 * 0.75^5 = 11.6.
  EXPECT_EQ(framesUntilChange(budget, 9.0), FrameBudget::kCalm + 4);
  EXPECT_FALSE(budget.less());
}

TEST(FrameBudget, WaitsLongerWhereAllIsSlowAgainSoon) {
  FrameBudget budget;
  int calm = FrameBudget::kCalm;
  for (int round = 0; round < 8; ++round) {
    ASSERT_GT(framesUntilChange(budget, 40.0), 0);
    if (round > 0) calm = std::min(2 * calm, FrameBudget::kMostCalm);
    EXPECT_EQ(budget.calm(), calm);
    ASSERT_GT(framesUntilChange(budget, 8.0), 0);
  }
  EXPECT_EQ(calm, FrameBudget::kMostCalm);
  // With all it was quick for long: the load is another.
  for (int i = 0; i < FrameBudget::kSoon; ++i) budget.note(14.0);
  EXPECT_EQ(budget.calm(), FrameBudget::kCalm);
}

}  // namespace
}  // namespace fettle::app
