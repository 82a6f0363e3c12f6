#include "app/work/live_change.h"

#include <cmath>

#include "engine/compare/compare.h"
#include "tests/app/work/loop_client_bench.h"
#include "tests/haptic/support/fields.h"

namespace fettle::app {
namespace {

using haptic::Tool;
using tests::LoopClientBench;

engine::Version rough(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  return tests::fieldOf(
      150, 120,
      [&](int c, int r) { return 0.05 * (c / 10 % 2) + 0.02 * tests::uniform(random, -1.0, 1.0) + 1e-3 * r; },
      0.1, 0.1);
}

class LiveChangeTest : public ::testing::Test {
 protected:
  // Until there are figures and nothing newer to look at.
  bool upToDate() {
    int quiet = 0;
    return bench.until([&] {
      if (change.poll(bench.client())) changed = true;
      quiet = change.figures() && change.figures()->max_abs == expected().max_abs ? quiet + 1 : 0;
      return quiet > 0;
    });
  }
  engine::Deviation expected() {
    engine::JobControl job;
    const auto measured = engine::compareFields(original, bench.client().upright(), job);
    EXPECT_TRUE(measured);
    return *measured;
  }

  engine::Version original = rough(3);
  LoopClientBench bench{original};
  LiveChange change;
  bool changed = false;
};

TEST_F(LiveChangeTest, a_field_that_is_as_scanned_has_not_changed) {
  EXPECT_FALSE(change.poll(bench.client())) << "before begin() there is nothing to look at";
  EXPECT_FALSE(change.figures());
  change.begin(original);
  EXPECT_FALSE(change.figures());
  ASSERT_TRUE(upToDate());
  EXPECT_TRUE(changed);
  EXPECT_EQ(change.figures()->samples, 150 * 120);
  EXPECT_EQ(change.figures()->max_abs, 0.0);
  EXPECT_EQ(change.figures()->rms, 0.0);
  EXPECT_EQ(change.figures()->sq, change.figures()->sq_original);
  EXPECT_EQ(change.figures()->histogram.unchanged, 150 * 120);
}

TEST_F(LiveChangeTest, figures_follow_strokes_and_undo) {
  change.begin(original);
  ASSERT_TRUE(upToDate());
  ASSERT_TRUE(bench.stroke(Tool::kSmooth, {5.0, 5.0, 0.05}));
  changed = false;
  ASSERT_TRUE(upToDate());
  EXPECT_TRUE(changed);
  const engine::LiveFigures& figures = *change.figures();
  const engine::Deviation measured = expected();
  EXPECT_GT(figures.max_abs, 0.0);
  EXPECT_EQ(figures.max_abs, measured.max_abs);
  // Sums of the same numbers in another order: 18,000 terms, each rounded to half a unit in the last place.
  EXPECT_NEAR(figures.rms, measured.rms, measured.rms * 18'000 * 1.2e-16);
  EXPECT_LT(figures.histogram.unchanged, 150 * 120);
  EXPECT_GE(change.tookMs(), 0.0);
  bench.client().undo();
  ASSERT_TRUE(bench.settled());
  ASSERT_TRUE(upToDate());
  EXPECT_EQ(change.figures()->max_abs, 0.0);
  EXPECT_EQ(change.figures()->histogram.unchanged, 150 * 120);
}

TEST_F(LiveChangeTest, what_has_been_looked_at_is_not_looked_at_again) {
  change.begin(original);
  ASSERT_TRUE(upToDate());
  const double took = change.tookMs();
  for (int i = 0; i < 200; ++i) {
    bench.client().poll();
    EXPECT_FALSE(change.poll(bench.client())) << i;
  }
  EXPECT_EQ(change.tookMs(), took);
}

TEST_F(LiveChangeTest, another_original_begins_again) {
  change.begin(original);
  ASSERT_TRUE(upToDate());
  change.begin(original);
  EXPECT_FALSE(change.figures()) << "those of the field before";
  ASSERT_TRUE(upToDate());
  EXPECT_EQ(change.figures()->max_abs, 0.0);
}

}  // namespace
}  // namespace fettle::app
