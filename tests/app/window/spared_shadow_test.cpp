#include "app/window/spared_shadow.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

const SparedShadow::Clock::time_point kStart{std::chrono::hours(1)};
constexpr auto kQuiet = SparedShadow::kQuiet;

TEST(SparedShadow, IsLeftOutOfSlowFramesWhileThePenMovesAndComesBackOnceAtRest) {
  SparedShadow shadow;
  shadow.moved(kStart);
  EXPECT_FALSE(shadow.shown(true, kStart));
  shadow.drawn(true);
  EXPECT_TRUE(shadow.pending());
  EXPECT_FALSE(shadow.due(true, kStart + kQuiet / 2));
  EXPECT_TRUE(shadow.due(true, kStart + kQuiet));
  EXPECT_TRUE(shadow.shown(true, kStart + kQuiet));
  shadow.drawn(false);
  EXPECT_FALSE(shadow.pending());
  EXPECT_FALSE(shadow.due(true, kStart + 2 * kQuiet)) << "one frame is enough";
  EXPECT_TRUE(shadow.shown(true, kStart + 2 * kQuiet)) << "a frame for another reason keeps it";
}

TEST(SparedShadow, IsThereWhereFramesAreQuick) {
  SparedShadow shadow;
  shadow.moved(kStart);
  EXPECT_TRUE(shadow.shown(false, kStart));
  shadow.drawn(true);
  EXPECT_TRUE(shadow.due(false, kStart)) << "frames became quick again";
}

}  // namespace
}  // namespace fettle::app
