// What effects cost: every kind has its row, and counted instructions are counted.
#include "bench/effects_bench.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "bench/instructions.h"
#include "haptic/scene/scene.h"

namespace fettle::bench {
namespace {

TEST(Instructions, TwiceTheWorkIsTwiceTheInstructionsOrNoneAreClaimed) {
  const auto spin = [](int rounds) {
    return countInstructions([rounds] {
      volatile int sink = 0;
      for (int i = 0; i < rounds; ++i) sink = sink + i;
    });
  };
  const InstructionCount once = spin(500);
  const InstructionCount twice = spin(1000);
  if (!once.instructions) {
    EXPECT_EQ(once.by, CountedBy::kNothing);
    GTEST_SKIP() << "instructions cannot be counted here";
  }
  // The loop takes at least a load, an addition, a store and a jump a round; calls around it are the same.
  EXPECT_GE(*once.instructions, 500 * 4);
  EXPECT_LE(*once.instructions, 500 * 20);
  const double ratio = static_cast<double>(*twice.instructions) / static_cast<double>(*once.instructions);
  EXPECT_NEAR(ratio, 2.0, 0.15);
  // Work that ends the process has no count, and this process continues.
  if (once.by == CountedBy::kSteps) {
    EXPECT_FALSE(countInstructions([] { std::abort(); }).instructions.has_value());
  }
}

TEST(EffectsBench, HasARowForEveryKindAndNothingIsHeldForNone) {
  EffectsBenchOptions options;
  options.side = 64;
  options.ticks = 1000;
  options.repeats = 2;
  engine::JobControl job;
  const auto report = benchEffects(options, job);
  ASSERT_TRUE(report.has_value());
  const auto row = [&](const std::string& ending) {
    const auto at = std::find_if(report->rows.begin(), report->rows.end(),
                                 [&](const EffectsBenchRow& r) { return r.name.ends_with(ending); });
    EXPECT_NE(at, report->rows.end()) << ending;
    return *at;
  };
  for (int k = 0; k < haptic::kEffectKinds; ++k)
    (void)row(std::string(haptic::effectName(static_cast<haptic::EffectKind>(k))));
  EXPECT_EQ(report->rows.front().name, "none");
  EXPECT_EQ(report->rows.front().bytes, 0);
  const EffectsBenchRow none = report->rows.front();
  const EffectsBenchRow all = row("all");
  EXPECT_GT(all.bytes, row("texture").bytes);
  EXPECT_GT(row("sphere tip, none").bytes, 0);
  for (const EffectsBenchRow& r : report->rows) {
    EXPECT_GT(r.contact_ticks, 100) << r.name;
    EXPECT_GT(r.fastest_ns, 0.0) << r.name;
    EXPECT_LE(r.fastest_ns, r.median_ns) << r.name;
    EXPECT_LE(r.median_ns, r.worst_ns) << r.name;
    EXPECT_EQ(r.instructions.has_value(), report->counted_by != CountedBy::kNothing) << r.name;
  }
  if (none.instructions) {
    EXPECT_LT(*none.instructions, *all.instructions);
  }
  // A form is taken out of what is touched before it is touched: a tick does the same, over tiles of their own. The heights
  // are those of the other rows up to rounding, which may lead a search over one cell more.
  for (const char* form : {"under a plane", "under a sphere"}) {
    EXPECT_GE(row(form).bytes, 64 * 64 * 4) << form;
    EXPECT_NEAR(static_cast<double>(row(form).contact_ticks), static_cast<double>(none.contact_ticks),
                0.02 * static_cast<double>(none.contact_ticks))
        << form;
    if (none.instructions) {
      EXPECT_NEAR(*row(form).instructions, *none.instructions, 0.25 * *none.instructions) << form;
    }
  }
}

TEST(EffectsBench, OptionsOutOfRangeAreRefused) {
  engine::JobControl job;
  for (const EffectsBenchOptions& bad : {EffectsBenchOptions{63, 1000, 1}, EffectsBenchOptions{64, 999, 1},
                                         EffectsBenchOptions{64, 1000, 0}}) {
    const auto report = benchEffects(bad, job);
    ASSERT_FALSE(report.has_value());
    EXPECT_EQ(report.error().kind, engine::ErrorKind::kInput);
  }
}

}  // namespace
}  // namespace fettle::bench
