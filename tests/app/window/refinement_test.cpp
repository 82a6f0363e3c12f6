#include "app/window/refinement.h"

#include <vector>

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

using std::chrono::milliseconds;

class RefinementOf64k : public testing::Test {
 protected:
  static constexpr std::int64_t kChosen = 65536;
  [[nodiscard]] std::int64_t frame(int at_ms, bool whole, bool coming = false) {
    const Refinement::Clock::time_point now = start + milliseconds(at_ms);
    const std::int64_t vertices = refinement.vertices(kChosen, 1, now).front();
    refinement.drawn({.whole = whole, .continued = !whole, .tiles_coming = coming}, now);
    return vertices;
  }
  [[nodiscard]] bool due(int at_ms) const { return refinement.due(start + milliseconds(at_ms)); }

  const Refinement::Clock::time_point start{std::chrono::hours(1)};
  Refinement refinement;
};

TEST_F(RefinementOf64k, ComesOnceThePictureHasNotChangedAsAWholeForAWhile) {
  refinement.drawn({.whole = true, .continued = false}, start);
  EXPECT_FALSE(due(249));
  EXPECT_TRUE(refinement.pending());
  // A brush draws parts again, and delays nothing.
  EXPECT_EQ(frame(100, false), kChosen);
  EXPECT_TRUE(due(250));
  EXPECT_EQ(frame(250, true), Refinement::kMost);
  EXPECT_FALSE(refinement.pending());
  EXPECT_FALSE(due(10'000));
  // And continues in the fine picture.
  EXPECT_EQ(frame(300, false), Refinement::kMost);
}

TEST_F(RefinementOf64k, OneSlowFrameAtMostWhenThePictureChangesAgain) {
  refinement.drawn({.whole = true, .continued = false}, start);
  EXPECT_EQ(frame(250, true), Refinement::kMost);
  EXPECT_EQ(frame(400, true), Refinement::kMost);
  EXPECT_EQ(frame(416, true), kChosen);
  EXPECT_EQ(frame(433, true), kChosen);
  EXPECT_FALSE(due(433 + 249));
  EXPECT_TRUE(due(433 + 250));
}

TEST_F(RefinementOf64k, WaitsForWhatIsOnItsWay) {
  refinement.drawn({.whole = true, .continued = false, .tiles_coming = true}, start);
  EXPECT_EQ(frame(200, false, true), kChosen);
  EXPECT_FALSE(due(449));
  EXPECT_EQ(frame(449, false, true), kChosen);
  EXPECT_EQ(frame(460, false, false), kChosen);
  EXPECT_EQ(frame(699, false, false), Refinement::kMost);
  // A result comes over while the picture is fine.
  EXPECT_EQ(frame(800, false, true), Refinement::kMost);
  EXPECT_EQ(frame(816, false, true), kChosen);
}

TEST_F(RefinementOf64k, GoesOnUntilAllBandsAreDrawn) {
  const auto at = [this](int ms) { return start + milliseconds(ms); };
  refinement.drawn({.whole = true, .continued = false}, start);
  EXPECT_FALSE(refinement.inBands());
  for (int left = 3; left >= 0; --left) {
    EXPECT_TRUE(refinement.due(at(300 - left)));
    EXPECT_EQ(refinement.vertices(kChosen, 1, at(300 - left)).front(), Refinement::kMost);
    EXPECT_TRUE(refinement.inBands());
    refinement.drawn({.bands_left = left}, at(300 - left));
  }
  EXPECT_FALSE(refinement.pending());
  EXPECT_FALSE(refinement.inBands());
  // What changes the picture as a whole meanwhile is drawn with the usual number.
  refinement.restart(at(400));
  EXPECT_EQ(refinement.vertices(kChosen, 1, at(700)).front(), Refinement::kMost);
  refinement.drawn({.bands_left = 3}, at(700));
  refinement.restart(at(701));
  EXPECT_FALSE(refinement.inBands());
  EXPECT_EQ(refinement.vertices(kChosen, 1, at(701)).front(), kChosen);
}

TEST_F(RefinementOf64k, TakesNoLessThanWasChosen) {
  refinement.drawn({.whole = true, .continued = false}, start);
  EXPECT_EQ(refinement.vertices(2 * Refinement::kMost, 1, start + milliseconds(300)).front(),
            2 * Refinement::kMost);
}

class RefinementOfFour : public RefinementOf64k {
 protected:
  using Vertices = std::vector<std::int64_t>;
  static constexpr std::int64_t kFine = Refinement::kMost, kShare = kChosen / 4;
  void SetUp() override { refinement.restart(start); }
  Vertices four(int at_ms, const Refinement::Drawn& drawn) {
    const Refinement::Clock::time_point now = start + milliseconds(at_ms);
    Vertices vertices = refinement.vertices(kChosen, 4, now);
    refinement.drawn(drawn, now);
    return vertices;
  }
  const Refinement::Drawn kWhole{.whole = true, .continued = false}, kPart{};
};

TEST_F(RefinementOfFour, EachPanelGetsWhatASinglePictureGetsOneAfterTheOther) {
  EXPECT_EQ(four(0, kWhole), Vertices(4, kShare));
  EXPECT_EQ(four(250, kPart), (Vertices{kFine, kShare, kShare, kShare}));
  EXPECT_TRUE(due(251));
  EXPECT_EQ(four(251, kPart), (Vertices{kFine, kFine, kShare, kShare}));
  EXPECT_EQ(four(252, kPart), (Vertices{kFine, kFine, kFine, kShare}));
  EXPECT_TRUE(refinement.pending());
  EXPECT_EQ(four(253, kPart), Vertices(4, kFine));
  EXPECT_FALSE(refinement.pending());
  EXPECT_FALSE(due(10'000));
  // A brush at rest.
  EXPECT_EQ(four(300, kPart), Vertices(4, kFine));
}

TEST_F(RefinementOfFour, APanelIsDrawnAgainUntilTheSamplesItAskedForAreThere) {
  (void)four(0, kWhole);
  EXPECT_EQ(four(250, {.pages_coming = true})[1], kShare);
  EXPECT_EQ(four(251, {.pages_coming = true})[1], kShare);
  EXPECT_EQ(four(252, kPart)[1], kShare);
  EXPECT_EQ(four(253, kPart)[1], kFine);
  // Samples that changed are worth another picture; those of the chosen one put the fine one off.
  EXPECT_EQ(four(254, {.tiles_coming = true})[2], kFine);
  EXPECT_EQ(four(255, {.pages_coming = true}), Vertices(4, kShare));
  EXPECT_FALSE(due(255 + 249));
  EXPECT_TRUE(due(255 + 250));
}

TEST_F(RefinementOfFour, AnotherChangeEndsItAndAViewThatMovesNeverWaitsForAFineFrame) {
  (void)four(0, kWhole);
  (void)four(250, kPart);
  EXPECT_EQ(four(251, kWhole), (Vertices{kFine, kFine, kShare, kShare}));
  EXPECT_EQ(four(252, kWhole), Vertices(4, kShare));
  for (int at = 600; refinement.pending(); ++at) (void)four(at, kPart);
  refinement.restart(start + milliseconds(700));
  EXPECT_EQ(four(700, kWhole), Vertices(4, kShare));
  // And so do more panels.
  for (int at = 1000; refinement.pending(); ++at) (void)four(at, kPart);
  EXPECT_EQ(refinement.vertices(kChosen, 5, start + milliseconds(1100)), Vertices(5, kChosen / 5));
}

TEST_F(RefinementOfFour, PanelsThatAreAlwaysDrawnTogetherFollowInOneFrame) {
  // As a picture for two eyes is drawn.
  (void)four(0, kWhole);
  EXPECT_EQ(four(250, kWhole), (Vertices{kFine, kShare, kShare, kShare}));
  EXPECT_EQ(four(500, kWhole), Vertices(4, kFine));
  EXPECT_FALSE(refinement.pending());
}

}  // namespace
}  // namespace fettle::app
