#include "app/view/refinement.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

using std::chrono::milliseconds;

class RefinementOf64k : public testing::Test {
 protected:
  static constexpr std::int64_t kChosen = 65536;
  [[nodiscard]] std::int64_t frame(int at_ms, bool whole, bool coming = false) {
    const Refinement::Clock::time_point now = start + milliseconds(at_ms);
    const std::int64_t vertices = refinement.vertices(kChosen, now);
    refinement.drawn(whole, coming, now);
    return vertices;
  }
  [[nodiscard]] bool due(int at_ms) const { return refinement.due(start + milliseconds(at_ms)); }

  const Refinement::Clock::time_point start{std::chrono::hours(1)};
  Refinement refinement;
};

TEST_F(RefinementOf64k, ComesOnceThePictureHasNotChangedAsAWholeForAWhile) {
  refinement.drawn(true, false, start);
  EXPECT_FALSE(due(249));
  EXPECT_TRUE(refinement.owed());
  // A brush draws parts anew, and puts nothing off.
  EXPECT_EQ(frame(100, false), kChosen);
  EXPECT_TRUE(due(250));
  EXPECT_EQ(frame(250, true), Refinement::kMost);
  EXPECT_FALSE(refinement.owed());
  EXPECT_FALSE(due(10'000));
  // And goes on in the fine picture.
  EXPECT_EQ(frame(300, false), Refinement::kMost);
}

TEST_F(RefinementOf64k, OneSlowFrameAtMostWhenThePictureChangesAgain) {
  refinement.drawn(true, false, start);
  EXPECT_EQ(frame(250, true), Refinement::kMost);
  EXPECT_EQ(frame(400, true), Refinement::kMost);
  EXPECT_EQ(frame(416, true), kChosen);
  EXPECT_EQ(frame(433, true), kChosen);
  EXPECT_FALSE(due(433 + 249));
  EXPECT_TRUE(due(433 + 250));
}

TEST_F(RefinementOf64k, WaitsForWhatIsOnItsWay) {
  refinement.drawn(true, true, start);
  EXPECT_EQ(frame(200, false, true), kChosen);
  EXPECT_FALSE(due(449));
  EXPECT_EQ(frame(449, false, true), kChosen);
  EXPECT_EQ(frame(460, false, false), kChosen);
  EXPECT_EQ(frame(699, false, false), Refinement::kMost);
  // A result comes over while the picture is fine.
  EXPECT_EQ(frame(800, false, true), Refinement::kMost);
  EXPECT_EQ(frame(816, false, true), kChosen);
}

TEST_F(RefinementOf64k, TakesNoLessThanWasChosen) {
  refinement.drawn(true, false, start);
  EXPECT_EQ(refinement.vertices(2 * Refinement::kMost, start + milliseconds(300)), 2 * Refinement::kMost);
}

}  // namespace
}  // namespace fettle::app
