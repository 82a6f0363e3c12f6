// A result that another thread worked out takes the place of the field under the hand.
#include "haptic/loop/loop_tick.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/difference.h"
#include "engine/field/live_field.h"
#include "haptic/loop/adopt_filtered.h"
#include "tests/haptic/loop/hand_device.h"
#include "tests/haptic/loop/touched_fields.h"

namespace fettle::haptic {
namespace {

using tests::bumpy;
using tests::kSide;
using tests::LoopBench;
using tests::reserve;
using tests::sceneWithBrush;
using tests::testOptions;

// A "filter" whose result is known: every sample raised by one.
engine::Version raised(const engine::Version& base) {
  engine::LiveField field(base, engine::Growth::kAllowed);
  std::vector<float> row(kSide);
  for (int r = 0; r < kSide; ++r) {
    base.reader().readHeights(0, r, kSide, 1, row.data(), kSide);
    for (float& z : row) z += 1.0F;
    EXPECT_TRUE(field.writeHeights(0, r, kSide, 1, row.data(), kSide));
  }
  return field.snapshot();
}

TEST(LoopAdoption, KeepsWhatTheHandDidMeanwhileAndReportsWhere) {
  const engine::Version start = bumpy();
  reserve(start);
  LoopBench bench(start, start, sceneWithBrush(1.0), testOptions(Tool::kSmooth));
  // The filter began here ...
  const engine::Version result = raised(start);
  // ... the hand continued in tile (0, 0) ...
  for (int i = 0; i < 60; ++i) bench.tickAt({3.0 + 0.5 * i, 30.0, -0.8});
  ASSERT_TRUE(bench.send(CommandKind::kSnapshot, [](LoopCommand& c) { c.id = 9; }));
  for (int i = 0; i < 3; ++i) bench.tickAt({33.0, 30.0, 2.0});
  const engine::Version snapshot = bench.newest(EventKind::kSnapshot).version;
  const auto merged = mergeResult(snapshot, start, result);
  ASSERT_TRUE(merged);
  ASSERT_EQ(merged->conflicts.size(), 1U);
  // ... and while the worker merged, in tile (2, 2).
  for (int i = 0; i < 30; ++i) bench.tickAt({150.0 + 0.5 * i, 150.0, -0.8});
  const engine::Version before = bench.field();
  ASSERT_TRUE(bench.send(CommandKind::kAdopt, [&](LoopCommand& c) {
    c.id = 9;
    c.version = merged->version;
  }));
  bench.tickAt({200.0, 200.0, 9.0});
  const LoopEvent event = bench.newest(EventKind::kAdopted);
  EXPECT_TRUE(event.retired == before);
  const auto carried = engine::changedTiles(merged->version, event.version);
  ASSERT_EQ(carried.size(), 1U);
  EXPECT_EQ(carried[0].tile_column, 2);
  EXPECT_EQ(carried[0].tile_row, 2);
  const engine::FieldReader now = event.version.reader();
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) {
      const bool mine = (c < 64 && r < 64) || (c / 64 == 2 && r / 64 == 2);
      const float want = mine ? before.reader().heightAt(c, r) : result.reader().heightAt(c, r);
      ASSERT_EQ(now.heightAt(c, r), want) << c << " " << r;
    }
  EXPECT_EQ(bench.loop.state().adopted, 1U);
  EXPECT_EQ(bench.loop.state().carried, 1U);
}

TEST(LoopAdoption, IsRefusedUnchangedWhenItsBaseIsOldTheHandWentTooFarOrThePoolIsDry) {
  const engine::Version start =
      fettle::tests::fieldOf(1200, 300, [](int c, int r) { return 0.3 * std::sin(1.0 * c * r); });
  reserve(start);
  LoopBench bench(start, start, sceneWithBrush(30.0), testOptions(Tool::kSmooth));
  const auto refused = [&](std::uint64_t id) {
    const engine::Version before = bench.field();
    EXPECT_TRUE(bench.send(CommandKind::kAdopt, [&](LoopCommand& c) {
      c.id = id;
      c.version = start;
    }));
    bench.tickAt({-5.0, 0.0, 0.0});
    const LoopEvent event = bench.newest(EventKind::kAdoptRefused);
    EXPECT_EQ(event.id, id);
    EXPECT_TRUE(event.retired == start);  // comes back to be freed
    EXPECT_TRUE(bench.field() == before);
    EXPECT_EQ(bench.loop.state().adopted, 0U);
  };
  const auto snapshot = [&](std::uint64_t id) {
    EXPECT_TRUE(bench.send(CommandKind::kSnapshot, [&](LoopCommand& c) { c.id = id; }));
    bench.tickAt({-5.0, 0.0, 0.0});
    return bench.newest(EventKind::kSnapshot);
  };
  refused(1);  // no snapshot at all
  static_cast<void>(snapshot(2));
  static_cast<void>(snapshot(3));
  refused(2);  // not the newest
  static_cast<void>(snapshot(4));
  for (int i = 0; i < 400; ++i) bench.tickAt({3.0 * i, 150.0 + 100.0 * std::sin(0.05 * i), -1.0});
  refused(4);  // over 64 tiles
  static_cast<void>(snapshot(5));
  for (int i = 0; i < 10; ++i) bench.tickAt({100.0 + i, 150.0, -1.0});
  static_cast<void>(bench.poll());
  std::vector<engine::Node*> nodes;
  while (engine::Node* node = start.memory()->nodes.tryAcquire()) nodes.push_back(node);
  refused(5);  // no node for the carried tiles
  for (engine::Node* node : nodes)
    if (engine::InnerPool::dropLast(node)) engine::InnerPool::recycle(node);
}

TEST(LoopAdoption, WithoutAnEditSinceTheSnapshotIsDoneAndCarriesNothing) {
  const engine::Version start = bumpy();
  reserve(start);
  LoopBench bench(start, start, sceneWithBrush(1.0), testOptions(Tool::kSmooth));
  const engine::Version result = raised(start);
  ASSERT_TRUE(bench.send(CommandKind::kSnapshot, [](LoopCommand& c) { c.id = 3; }));
  bench.tickAt({200.0, 200.0, 9.0});
  ASSERT_TRUE(bench.send(CommandKind::kAdopt, [&](LoopCommand& c) {
    c.id = 3;
    c.version = result;
  }));
  bench.tickAt({200.0, 200.0, 9.0});
  EXPECT_TRUE(bench.newest(EventKind::kAdopted).version == result);
  EXPECT_TRUE(bench.field() == result);
  EXPECT_EQ(bench.loop.state().adopted, 1U);
  EXPECT_EQ(bench.loop.state().carried, 0U);
}

}  // namespace
}  // namespace fettle::haptic
