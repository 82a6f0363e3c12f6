// The truth that methods of contact are measured against, on fields of a few samples.
#include "haptic/trials/contact_trial.h"

#include <gtest/gtest.h>

#include "tests/haptic/support/fields.h"

namespace fettle::trials {
namespace {

using fettle::tests::fieldOf;
using fettle::tests::kHole;

// Where the true centre of a ball is, the surface is a radius away.
TEST(ContactTrial, OfABallItsTruthLiesARadiusFromTheSurface) {
  engine::JobControl job;
  for (const int side : {2, 3, 5, 9}) {
    const auto trial = ContactTrial::make(
        fieldOf(side, side, [](int c, int r) { return 0.3 * ((3 * c + 5 * r) % 4); }), 1.0, 2000, job);
    ASSERT_TRUE(trial && trial->has_value()) << side;
    // Of the grown surface, which is too low by (1 / 8)^2 / 4 of a cell and more at sharp places.
    EXPECT_LT((*trial)->truthError(), 0.05) << side;
    const auto figures = (*trial)->measure({"ball", haptic::ContactLevel::kPaper, 2048, 2, 1.0}, 1, job);
    ASSERT_TRUE(figures);
    EXPECT_GT(figures->ticks, 100) << side;
  }
}

TEST(ContactTrial, AFieldWithoutCellsOrWithoutASquareThatIsWholeHasNone) {
  engine::JobControl job;
  const auto none = [&](const engine::Version& field, double ball) {
    const auto trial = ContactTrial::make(field, ball, 100, job);
    return trial && !trial->has_value();
  };
  EXPECT_TRUE(none(fieldOf(1, 9, [](int, int) { return 0.0; }), 0.0));
  EXPECT_TRUE(none(fieldOf(9, 9, [](int c, int r) { return c == 4 && r == 4 ? kHole : 0.0F; }), 1.0));
  EXPECT_FALSE(none(fieldOf(9, 9, [](int c, int r) { return c == 4 && r == 4 ? kHole : 0.0F; }), 0.0));
}

}  // namespace
}  // namespace fettle::trials
