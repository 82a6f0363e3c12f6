#include "bench/haptic_bench.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

namespace fettle::bench {
namespace {

// A tick that only feels changes no field: its hash must be of what was felt, or a faster search that finds other points
// would show the same hash.
TEST(HapticBench, TheHashOfARowTellsSearchesApartThatFeelOtherPoints) {
  HapticBenchOptions options;
  options.side = 128;
  options.ticks = 4000;
  options.repeats = 2;
  options.speeds_mm_s = {20.0};
  engine::JobControl job;
  const auto report = benchHaptic(options, job);
  ASSERT_TRUE(report) << report.error().line();
  const auto again = benchHaptic(options, job);
  ASSERT_TRUE(again) << again.error().line();
  ASSERT_EQ(again->rows.size(), report->rows.size());
  for (std::size_t i = 0; i < report->rows.size(); ++i)
    EXPECT_EQ(again->rows[i].hash, report->rows[i].hash) << report->rows[i].ground << report->rows[i].name;
  const auto hashOf = [&](const std::string& name) {
    const auto row = std::ranges::find_if(
        report->rows, [&](const HapticBenchRow& r) { return r.ground == "rough part" && r.name == name; });
    EXPECT_NE(row, report->rows.end()) << name;
    return row == report->rows.end() ? 0 : row->hash;
  };
  // The lower bounds stand on every ground, over the ticks of what they bound.
  for (const HapticBenchRow& row : report->rows) {
    if (!row.name.starts_with("plain array, the least of")) continue;
    EXPECT_GT(row.contact_ticks, 0) << row.ground << row.name;
    EXPECT_GE(row.cells, 1.0) << row.ground << row.name;
    EXPECT_EQ(row.ticks, row.name.ends_with("a ball") ? options.ticks / 10 : options.ticks);
  }
  EXPECT_NE(hashOf("plain array, the least of a ball"), hashOf("plain array, the least of level paper"));
  EXPECT_NE(hashOf("paper, feel"), hashOf("descent, feel"));
  EXPECT_NE(hashOf("paper, feel"), hashOf("certified radius 2, feel"));
  EXPECT_NE(hashOf("ball r = 2 samples, to rest"), hashOf("the same, as before contact revision 4"));
  // No steep cell is there.
  EXPECT_EQ(hashOf("ball r = 2 samples, to rest"), hashOf("the same, minima of equal pieces"));
}

}  // namespace
}  // namespace fettle::bench
