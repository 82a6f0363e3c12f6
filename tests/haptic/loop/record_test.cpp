// The record of a session: what the loop writes down is what its ticks saw, so a replay of it is the session.
#include <vector>

#include <gtest/gtest.h>

#include "haptic/base/rt_thread.h"
#include "haptic/tick/replay.h"
#include "tests/haptic/loop/hand_device.h"
#include "tests/haptic/support/fields.h"

namespace fettle::haptic {
namespace {

using tests::LoopBench;
using tests::testOptions;

engine::Version bumpyOf200() {
  return fettle::tests::fieldOf(200, 200,
                                [](int c, int r) { return 0.3 * std::sin(0.9 * c) * std::cos(0.7 * r); });
}

std::vector<StrokeSample> taken(LoopBench& bench) {
  std::vector<StrokeSample> rows;
  for (TickRecord record; bench.channels.records.pop(record);) rows.push_back(record.input);
  return rows;
}

TEST(Record, ReplayOfTheRecordGivesTheFieldOfTheLoopBitForBit) {
  const engine::Version start = bumpyOf200();
  ASSERT_TRUE(start.memory()->tiles.reserve(200) && start.memory()->nodes.reserve(100));
  Scene scene = defaultScene();
  scene.brush_radius_samples = 1.5;
  LoopOptions options = testOptions(Tool::kSmooth);
  options.record_capacity = 4096;
  LoopBench bench(start, start, scene, options);
  const DenormalScope as_on_the_loops_thread;
  for (std::uint64_t i = 0; i < 3000; ++i) {
    // Dropouts, uneven ticks and a tool that changes are part of it.
    bench.device.input.link = i % 500 > 480 ? LinkState::kDisconnected : LinkState::kConnected;
    bench.device.input.tool = i / 700 % 2 == 0 ? Tool::kSmooth : Tool::kMark;
    bench.device.input.position_mm = tests::sweep(i, 199.0, -0.2, 0.6);
    bench.tick(900'000 + static_cast<std::int64_t>(i % 7) * 50'000);
    static_cast<void>(bench.poll());  // its versions hold tiles
  }
  EXPECT_EQ(bench.loop.state().lost_records, 0U);
  ASSERT_EQ(bench.loop.state().refused_edits, 0U);
  const std::vector<StrokeSample> rows = taken(bench);
  ASSERT_EQ(rows.size(), 3000U);
  EXPECT_EQ(rows.front().t, 0.0);
  engine::JobControl job;
  const auto again = replay(start, start, rows, scene, {}, job);
  ASSERT_TRUE(again);
  EXPECT_GT(again->report.samples_changed, 100);
  EXPECT_GT(again->report.marked, 100);
  EXPECT_EQ(engine::contentHash(again->field), engine::contentHash(bench.field()));
}

TEST(Record, FullRingIsCountedAndTheLoopGoesOn) {
  const engine::Version start = bumpyOf200();
  LoopOptions options = testOptions(Tool::kFeel);
  options.record_capacity = 64;
  LoopBench bench(start, start, defaultScene(), options);
  for (int i = 0; i < 100; ++i) bench.tickAt({50.0, 50.0, 1.0});
  EXPECT_EQ(bench.loop.state().lost_records, 36U);
  EXPECT_EQ(bench.loop.state().tick, 100U);
  EXPECT_EQ(taken(bench).size(), 64U);
  bench.tickAt({50.0, 50.0, 1.0});
  EXPECT_EQ(bench.loop.state().lost_records, 36U);
}

TEST(Record, NothingIsRecordedUnlessAskedFor) {
  const engine::Version start = bumpyOf200();
  LoopBench bench(start, start, defaultScene(), testOptions(Tool::kFeel));
  for (int i = 0; i < 10; ++i) bench.tickAt({50.0, 50.0, 1.0});
  EXPECT_TRUE(taken(bench).empty());
  EXPECT_EQ(bench.loop.state().lost_records, 0U);
}

TEST(EditRule, ToolsWaitUntilForceIsGivenAndStopWithAFault) {
  const engine::Version start = bumpyOf200();
  ASSERT_TRUE(start.memory()->tiles.reserve(100) && start.memory()->nodes.reserve(100));
  LoopOptions options = testOptions(Tool::kSmooth);
  options.edit_rule = EditRule::kWhileForceIsGiven;
  LoopBench bench(start, start, defaultScene(), options);
  for (int i = 0; i < 50; ++i) bench.tickAt({50.0 + 0.1 * i, 50.0, -0.5});
  EXPECT_EQ(bench.loop.state().tool, Tool::kFeel);
  EXPECT_TRUE(bench.field() == start);
  bench.device.input.position_mm.z = 3.0;
  ASSERT_TRUE(bench.send(CommandKind::kArm));
  for (int i = 0; i < 50; ++i) bench.tick();
  for (int i = 0; i < 50; ++i) bench.tickAt({50.0 + 0.1 * i, 50.0, -0.5});
  EXPECT_EQ(bench.loop.state().tool, Tool::kSmooth);
  EXPECT_FALSE(bench.field() == start);
  bench.tick(200'000'000);  // held up: a fault
  ASSERT_EQ(bench.loop.state().safety, SafetyState::kFault);
  const engine::Version kept = bench.field();
  for (int i = 0; i < 50; ++i) bench.tickAt({60.0 + 0.1 * i, 50.0, -0.5});
  EXPECT_EQ(bench.loop.state().tool, Tool::kFeel);
  EXPECT_TRUE(bench.field() == kept);
}

}  // namespace
}  // namespace fettle::haptic
