#include "app/window/picture_at_rest.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

using std::chrono::milliseconds;

class AtRest : public testing::Test {
 protected:
  [[nodiscard]] bool due(int at_ms) const { return rest.due(start + milliseconds(at_ms)); }
  void frame(int at_ms, const PictureAtRest::Drawn& drawn) { rest.drawn(drawn, start + milliseconds(at_ms)); }

  const PictureAtRest::Clock::time_point start{std::chrono::hours(1)};
  PictureAtRest rest;
};

TEST_F(AtRest, BeginsWhenNothingWasDrawnAgainForAWhile) {
  frame(0, {.changed = true});
  EXPECT_FALSE(due(399));
  frame(300, {});  // panels, lines
  EXPECT_TRUE(due(400));
  for (int left = 8; left > 0; --left) {
    frame(400 + left, {.at_rest = true, .left = left});
    EXPECT_TRUE(due(420));
    EXPECT_TRUE(rest.pending());
  }
  frame(420, {.at_rest = true, .left = 0});
  EXPECT_FALSE(due(1'000'000));
  EXPECT_FALSE(rest.pending());
  frame(500, {.at_rest = true, .left = 0});  // a line moves
  EXPECT_FALSE(rest.pending());
}

TEST_F(AtRest, AStrokeEndsIt) {
  frame(0, {.changed = true});
  frame(400, {.at_rest = true, .left = 8});
  // The frame was asked for at rest, and the field had changed.
  frame(416, {.changed = true, .at_rest = true, .left = 8});
  EXPECT_FALSE(due(417));
  EXPECT_FALSE(rest.rests(start + milliseconds(815)));
  EXPECT_TRUE(due(816));
  frame(830, {.at_rest = true, .left = 0});
  frame(900, {.changed = true});
  EXPECT_TRUE(rest.pending());
  EXPECT_FALSE(due(1299));
}

// Frames that cannot go on from each other are drawn as a whole each: it gives up until something else changes.
TEST_F(AtRest, DoesNotAskForFramesThatBeginAnewForEver) {
  frame(0, {.changed = true});
  frame(400, {.changed = true, .at_rest = true, .left = 8, .asked_here = true});
  EXPECT_FALSE(due(10'000));
  EXPECT_FALSE(rest.pending());
  frame(10'000, {.changed = true});
  EXPECT_TRUE(due(10'400));
}

// For two eyes a frame at rest is one as any other, drawn as a whole: it must not ask for the next one.
TEST_F(AtRest, WithoutSuchAPictureItEndsAtOnce) {
  frame(0, {.changed = true});
  EXPECT_TRUE(due(400));
  frame(400, {.changed = true, .at_rest = true, .left = 0});
  EXPECT_FALSE(due(10'000));
}

}  // namespace
}  // namespace fettle::app
