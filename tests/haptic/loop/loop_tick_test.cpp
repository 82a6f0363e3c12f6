#include "haptic/loop/loop_tick.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/live_field.h"
#include "haptic/tick/replay.h"
#include "tests/haptic/loop/hand_device.h"
#include "tests/haptic/loop/touched_fields.h"
#include "tests/haptic/support/fields.h"

namespace fettle::haptic {
namespace {

using tests::bumpy;
using tests::DeskDevice;
using tests::kSide;
using tests::LoopBench;
using tests::Mirror;
using tests::reserve;
using tests::sceneWithBrush;
using tests::sweep;
using tests::testOptions;

TEST(LoopTick, LiveSessionEqualsTheReplayOfItsStrokes) {
  const engine::Version start = bumpy();
  reserve(start);
  for (const bool invert : {false, true}) {
    Scene scene = sceneWithBrush(2.0);
    scene.invert = invert;
    LoopBench bench(start, start, scene, testOptions(Tool::kFeel));
    std::vector<StrokeSample> strokes;
    for (std::uint64_t i = 0; i < 20000; ++i) {
      const Tool tool = static_cast<Tool>(i / 500 % kTools);
      const glm::dvec3 tip = sweep(i, kSide - 1.0, 0.1, 0.8);
      bench.device.input.tool = tool;
      bench.tickAt(tip);
      static_cast<void>(bench.poll());
      strokes.push_back({1e-3 * static_cast<double>(i), tip, tool});
    }
    engine::JobControl job;
    const auto replayed = replay(start, start, strokes, scene, {}, job);
    ASSERT_TRUE(replayed);
    const engine::Version live = invert ? bench.field().inverted() : bench.field();
    EXPECT_EQ(engine::contentHash(live), engine::contentHash(replayed->field));
    EXPECT_GT(replayed->report.samples_changed, 1000);
    EXPECT_EQ(bench.loop.state().refused_edits, 0U);
  }
}

TEST(LoopTick, EditsThatCameThroughTheRingMakeTheSameFieldEvenWhenTheReaderStalls) {
  const engine::Version start = bumpy();
  reserve(start);
  LoopOptions options = testOptions(Tool::kFeel);
  options.event_capacity = 8;
  LoopBench bench(start, start, sceneWithBrush(1.5), options);
  Mirror mirror(start);
  engine::Version newest = start;
  std::uint64_t events = 0;
  for (std::uint64_t i = 0; i < 40000; ++i) {
    bench.device.input.tool = static_cast<Tool>(i / 700 % kTools);
    bench.tickAt(sweep(i, kSide - 1.0, 0.1, 0.8));
    // Stalls for 3,000 ticks, then is quick for as many.
    if (i % 6000 < 3000 && i % 3000 != 0) continue;
    for (LoopEvent& event : bench.poll()) {
      EXPECT_TRUE(event.before == newest) << "a state was left out";
      mirror.take(event.version, event.rect);
      newest = event.version;
      ++events;
    }
  }
  bench.loop.stop();
  for (LoopEvent& event : bench.poll()) mirror.take(event.version, event.rect);
  EXPECT_EQ(mirror.differences(bench.field()), 0U);
  EXPECT_GT(bench.loop.state().merged, 1000U);
  EXPECT_GT(events, 500U);
}

TEST(LoopTick, ToolThatChangesNothingPublishesNothing) {
  const engine::Version flat = fettle::tests::fieldOf(kSide, kSide, [](int, int) { return 0.0; });
  reserve(flat);
  LoopBench bench(flat, flat, sceneWithBrush(3.0), testOptions(Tool::kSmooth));
  for (int i = 0; i < 500; ++i) bench.tickAt({100.3, 100.4, -0.5});
  EXPECT_TRUE(bench.poll().empty());
  EXPECT_TRUE(bench.field() == flat);
}

TEST(LoopTick, StrokeEndsWithTheButtonAndReportsTheCommittedVersion) {
  const engine::Version start = bumpy();
  reserve(start);
  LoopOptions options = testOptions(Tool::kMark);
  options.tool_switch = ToolSwitch::kButton;
  LoopBench bench(start, start, sceneWithBrush(0.0), options);
  for (int i = 0; i < 50; ++i) bench.tickAt({20.0 + i, 30.0, -1.0});
  bench.device.input.buttons = 0;
  for (int i = 0; i < 5; ++i) bench.tickAt({70.0 + i, 30.0, -1.0});
  const LoopEvent event = bench.newest(EventKind::kStrokeEnded);
  EXPECT_EQ(event.stroke, 1U);
  EXPECT_TRUE(event.version == bench.field());
  EXPECT_GT(engine::summarize(event.version).marked, 40);
  // No button, no tool.
  EXPECT_FALSE(event.version.reader().markedAt(73, 30));
}

TEST(LoopTick, WhatIsTouchedIsShownToTheDeviceWithAStrengthWhileItIsArmed) {
  const engine::Version flat = fettle::tests::fieldOf(kSide, kSide, [](int, int) { return 0.0; });
  reserve(flat);
  const Scene scene = sceneWithBrush(0.0);
  LoopBench bench(flat, flat, scene, testOptions(Tool::kFeel));
  const auto press = [&](double depth_mm, int ticks) {
    for (int i = 0; i < ticks; ++i) bench.tickAt({20.0, 30.0, -depth_mm});
    return bench.device.shown;
  };
  press(-5.0, 50);
  EXPECT_FALSE(press(-5.0, 1).contact);
  EXPECT_TRUE(press(0.5, 20).contact);
  EXPECT_EQ(press(0.5, 1).strength, 0.0) << "not armed";
  EXPECT_NEAR(bench.device.shown.proxy_mm.z, 0.0, 1e-6);
  press(-5.0, 50);
  ASSERT_TRUE(bench.send(CommandKind::kArm));
  press(-5.0, 1200);
  EXPECT_NEAR(press(0.5, 20).strength, 0.5 * scene.stiffness_n_per_mm / scene.force_limit_n, 1e-3);
  EXPECT_NEAR(bench.device.shown.force_n.z, 0.5 * scene.stiffness_n_per_mm, 0.02);
  EXPECT_EQ(press(100.0, 20).strength, 1.0);
  bench.channels.disarm();
  EXPECT_EQ(press(100.0, 50).strength, 0.0);
  bench.loop.stop();
  EXPECT_FALSE(bench.device.shown.contact);
}

TEST(LoopTick, UnplugMidStrokeKeepsTheStrokeAndGivesNoForce) {
  const engine::Version start = bumpy();
  reserve(start);
  LoopBench bench(start, start, sceneWithBrush(0.0), testOptions(Tool::kMark));
  ASSERT_TRUE(bench.send(CommandKind::kArm));
  for (int i = 0; i < 1200; ++i) bench.tickAt({20.0, 30.0, 5.0});
  for (int i = 0; i < 50; ++i) bench.tickAt({20.0 + i, 30.0, -1.0});
  EXPECT_GT(bench.device.force.z, 0.5);
  bench.device.input.link = LinkState::kDisconnected;
  for (int i = 0; i < 20; ++i) bench.tick();
  EXPECT_EQ(glm::length(bench.device.force), 0.0);
  EXPECT_EQ(bench.loop.guard().state(), SafetyState::kFault);
  EXPECT_GT(engine::summarize(bench.newest(EventKind::kStrokeEnded).version).marked, 40);
  // Plugged in again: nothing until armed, and then not a jolt.
  bench.device.input.link = LinkState::kConnected;
  for (int i = 0; i < 100; ++i) bench.tick();
  EXPECT_EQ(glm::length(bench.device.force), 0.0);
  ASSERT_TRUE(bench.send(CommandKind::kArm));
  for (int i = 0; i < 100; ++i) bench.tick();
  EXPECT_EQ(bench.loop.guard().state(), SafetyState::kArmed);
  EXPECT_EQ(glm::length(bench.device.force), 0.0);
}

// Who follows the events reads and draws what they name: no more than the brush reached, and nothing beside the field.
TEST(LoopTick, AnEditNamesTheSamplesUnderTheBrushAndNoOthers) {
  const engine::Version start = bumpy();
  reserve(start);
  for (const glm::dvec2 at : {glm::dvec2{50.3, 120.4}, {0.2, 0.3}, {298.6, 298.7}}) {
    LoopBench bench(start, start, sceneWithBrush(2.0), testOptions(Tool::kMark));
    for (int i = 0; i < 20; ++i) bench.tickAt({at, -1.0});
    bench.loop.stop();
    const engine::SampleRect rect = bench.newest(EventKind::kStrokeEnded).rect;
    ASSERT_FALSE(rect.empty());
    EXPECT_LE(rect.columns, 5);
    EXPECT_LE(rect.rows, 5);
    EXPECT_GE(rect.column, 0);
    EXPECT_GE(rect.row, 0);
    EXPECT_LE(rect.column + rect.columns, kSide);
    EXPECT_LE(rect.row + rect.rows, kSide);
    Mirror mirror(start);
    mirror.take(bench.field(), rect);
    EXPECT_EQ(mirror.differences(bench.field()), 0U);
  }
}

TEST(LoopTick, UndoWhileTouchingIsExactAndRedoHasTheRunningStroke) {
  const engine::Version start = bumpy();
  reserve(start);
  LoopBench bench(start, start, sceneWithBrush(1.0), testOptions(Tool::kSmooth));
  for (int i = 0; i < 200; ++i) bench.tickAt({3.0 + 0.5 * i, 30.0, -0.8});
  const engine::Version touched = bench.field();
  static_cast<void>(bench.poll());
  ASSERT_TRUE(bench.send(CommandKind::kRestore, [&](LoopCommand& c) { c.version = start; }));
  bench.device.input.tool = Tool::kFeel;
  bench.tickAt({103.5, 30.0, -0.8});
  LoopEvent event = bench.newest(EventKind::kRestored);
  EXPECT_TRUE(event.version == start);
  EXPECT_TRUE(bench.field() == start);
  EXPECT_TRUE(event.retired == touched);
  EXPECT_TRUE(bench.loop.state().contact);  // still touching, the restored surface
  // Redo.
  ASSERT_TRUE(bench.send(CommandKind::kRestore, [&](LoopCommand& c) { c.version = event.retired; }));
  bench.tick();
  EXPECT_TRUE(bench.field() == touched);
}

// As when a form is taken out: the field lies elsewhere, and so does what limits its changes.
TEST(LoopTick, AnotherOriginalLimitsChangesFromTheTickOfItsVersionOn) {
  constexpr double kMost = 0.01;
  const engine::Version start = bumpy();
  reserve(start);
  engine::LiveField live(start, engine::Growth::kAllowed);
  const engine::Grid& grid = start.grid();
  std::vector<float> z(static_cast<std::size_t>(grid.samples()));
  start.reader().readHeights(0, 0, grid.width, grid.height, z.data(), grid.width);
  for (float& height : z) height += 100.0F;
  ASSERT_TRUE(live.writeHeights(0, 0, grid.width, grid.height, z.data(), grid.width));
  const engine::Version raised = live.snapshot();
  reserve(start);
  Scene scene = sceneWithBrush(1.0);
  scene.max_change = kMost;
  LoopBench bench(start, start, scene, testOptions(Tool::kSmooth));
  for (int i = 0; i < 50; ++i) bench.tickAt({3.0 + 0.5 * i, 30.0, -0.8});
  const engine::Version touched = bench.field();
  static_cast<void>(bench.poll());
  ASSERT_TRUE(bench.send(CommandKind::kRestore, [&](LoopCommand& c) {
    c.version = raised;
    c.scene = std::make_unique<PreparedScene>(scene, raised);
  }));
  bench.tickAt({30.0, 40.0, 99.2});
  LoopEvent event = bench.newest(EventKind::kRestored);
  EXPECT_TRUE(event.retired == touched);
  ASSERT_NE(event.retired_scene, nullptr);
  for (int i = 0; i < 200; ++i) bench.tickAt({30.0 + 0.5 * i, 40.0, 99.2});
  std::vector<float> edited(z.size());
  bench.field().reader().readHeights(0, 0, grid.width, grid.height, edited.data(), grid.width);
  std::int64_t changed = 0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    changed += edited[i] != z[i];
    // To the rounding of heights about 100.
    ASSERT_LE(std::abs(edited[i] - z[i]), kMost + 8e-6) << i;
  }
  EXPECT_GT(changed, 10);
}

TEST(LoopTick, DryPoolRefusesEditsCountsThemAndLeavesTheFieldWhole) {
  const engine::Version start = bumpy();
  // The field's own slab may have tiles left: take them all.
  std::vector<engine::TileRef> taken;
  while (engine::Tile* tile = start.memory()->tiles.tryAcquire())
    taken.push_back(engine::TileRef::adopt(tile));
  LoopBench bench(start, start, sceneWithBrush(1.0), testOptions(Tool::kSmooth));
  for (int i = 0; i < 100; ++i) bench.tickAt({50.0, 50.0, -0.8});
  EXPECT_GT(bench.loop.state().refused_edits, 50U);
  EXPECT_EQ(engine::contentHash(bench.field()), engine::contentHash(start));
  taken.clear();
  for (int i = 0; i < 100; ++i) bench.tickAt({50.0, 50.0, -0.8});
  EXPECT_NE(engine::contentHash(bench.field()), engine::contentHash(start));
}

TEST(LoopTick, SceneIsSwappedUnderTheTipWithTheFieldAsItIs) {
  const engine::Version start = bumpy();
  reserve(start);
  LoopBench bench(start, start, sceneWithBrush(1.0), testOptions(Tool::kSmooth));
  for (int i = 0; i < 100; ++i) bench.tickAt({50.0 + 0.1 * i, 50.0, -0.8});
  const engine::Version before = bench.field();
  Scene stiff = sceneWithBrush(0.0);
  stiff.stiffness_n_per_mm = 3.0;
  stiff.invert = true;
  ASSERT_TRUE(bench.send(CommandKind::kScene,
                         [&](LoopCommand& c) { c.scene = std::make_unique<PreparedScene>(stiff, start); }));
  bench.device.input.tool = Tool::kFeel;
  bench.tickAt({60.0, 50.0, -0.8});
  const LoopEvent event = bench.newest(EventKind::kSceneChanged);
  ASSERT_NE(event.retired_scene, nullptr);
  EXPECT_EQ(bench.field().reader().heightAt(50, 50), -before.reader().heightAt(50, 50));
  EXPECT_EQ(bench.loop.scene().scene, stiff);
}

TEST(LoopTick, DisarmOvertakesEveryCommandAndTheArmingsBeforeIt) {
  const engine::Version start = bumpy();
  reserve(start);
  LoopOptions options = testOptions(Tool::kFeel);
  options.event_capacity = 8;
  LoopBench bench(start, start, sceneWithBrush(1.0), options);
  ASSERT_TRUE(bench.channels.commands.push(bench.channels.armCommand()));
  bench.tickAt({50.0, 50.0, 5.0});
  for (int i = 0; i < 500; ++i) bench.tickAt({50.0, 50.0, 1.0});
  ASSERT_EQ(bench.loop.guard().state(), SafetyState::kActive);
  // Nobody takes events: the ninth question holds up all that comes after it.
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(bench.send(CommandKind::kSnapshot));
  ASSERT_TRUE(bench.channels.commands.push(bench.channels.armCommand()));
  for (int i = 0; i < 30; ++i) bench.tickAt({50.0, 50.0, 1.0});
  ASSERT_EQ(bench.channels.events.freePlaces(), 0U);
  bench.channels.disarm();
  bench.tickAt({50.0, 50.0, 1.0});
  EXPECT_EQ(bench.loop.guard().state(), SafetyState::kUncalibrated);
  // Once things move again the arming from before it comes up, and is void.
  for (int i = 0; i < 50; ++i) {
    static_cast<void>(bench.poll());
    bench.tickAt({50.0, 50.0, 1.0});
    ASSERT_EQ(bench.loop.guard().state(), SafetyState::kUncalibrated) << i;
  }
  // Who arms after it has it armed.
  ASSERT_TRUE(bench.channels.commands.push(bench.channels.armCommand()));
  bench.tickAt({50.0, 50.0, 1.0});
  EXPECT_EQ(bench.loop.guard().state(), SafetyState::kRamping);
}

// The disarm falls between the tick's look at their number and its taking the command: the tick knows of it by the command alone.
TEST(LoopTick, AnArmingAfterADisarmThatTheTickHasNotSeenBeginsWithoutForceAndStays) {
  const engine::Version start = bumpy();
  reserve(start);
  LoopBench bench(start, start, sceneWithBrush(1.0), testOptions(Tool::kFeel));
  ASSERT_TRUE(bench.channels.commands.push(bench.channels.armCommand()));
  for (int i = 0; i < 600; ++i) bench.tickAt({50.0, 50.0, 5.0});
  for (int i = 0; i < 20; ++i) bench.tickAt({50.0, 50.0, -1.0});
  ASSERT_EQ(bench.loop.guard().state(), SafetyState::kActive);
  ASSERT_GT(bench.device.force.z, 0.5);
  ASSERT_TRUE(bench.send(CommandKind::kArm, [](LoopCommand& c) { c.id = 1; }));
  bench.tickAt({50.0, 50.0, -1.0});
  EXPECT_EQ(bench.loop.guard().state(), SafetyState::kArmed) << "a force goes on that was switched off";
  bench.channels.disarm();  // its number becomes visible
  for (int i = 0; i < 20; ++i) bench.tickAt({50.0, 50.0, -1.0});
  EXPECT_EQ(glm::length(bench.device.force), 0.0);
  EXPECT_EQ(bench.loop.guard().state(), SafetyState::kArmed) << "the arming after the disarm was lost";
}

TEST(LoopTick, WhatWasMarkedJustBeforeTheEndIsReportedByTheStop) {
  const engine::Version start = bumpy();
  reserve(start);
  const LoopOptions options = testOptions(Tool::kMark);
  LoopBench bench(start, start, sceneWithBrush(0.0), options);
  for (std::uint32_t i = 0; i + 2 < options.publish_ticks; ++i) bench.tickAt({20.0 + 0.1 * i, 30.0, -1.0});
  ASSERT_TRUE(bench.poll().empty()) << "ticks fewer than those between two reports";
  bench.loop.stop();
  const LoopEvent event = bench.newest(EventKind::kStrokeEnded);
  ASSERT_TRUE(event.version == bench.field());
  EXPECT_GT(engine::summarize(event.version).marked, 0);
}

TEST(LoopTick, ClutchHoldsTheTipAndGivesNoForce) {
  const engine::Version start = bumpy();
  reserve(start);
  DeskDevice device;
  LoopOptions options = testOptions(Tool::kFeel);
  options.workspace = Workspace(0.5, {100.0, 100.0, 0.0});
  LoopChannels channels(options);
  LoopTick loop(std::make_unique<PreparedScene>(defaultScene(), start), start, device, channels, options);
  const auto tick = [&](glm::dvec3 at, std::uint32_t buttons) {
    device.input.position_mm = at;
    device.input.buttons = buttons;
    device.now_ns += 1'000'000;
    loop.run(device.now_ns, 1'000'000);
  };
  tick({10.0, 0.0, 4.0}, 0);
  EXPECT_EQ(loop.state().endpoint_mm, glm::dvec3(105.0, 100.0, 2.0));
  tick({10.0, 0.0, 4.0}, kSecondaryButton);
  tick({-30.0, 7.0, 1.0}, kSecondaryButton);
  EXPECT_EQ(loop.state().endpoint_mm, glm::dvec3(105.0, 100.0, 2.0));
  tick({-30.0, 7.0, 1.0}, 0);
  EXPECT_EQ(loop.state().endpoint_mm, glm::dvec3(105.0, 100.0, 2.0));
  tick({-29.0, 7.0, 1.0}, 0);
  EXPECT_EQ(loop.state().endpoint_mm, glm::dvec3(105.5, 100.0, 2.0));
}

TEST(LoopTick, TheStylusIsTurnedWithTheWorkspace) {
  const engine::Version start = bumpy();
  reserve(start);
  DeskDevice device;
  device.input.position_mm = {1.0, 2.0, 30.0};
  LoopOptions options = testOptions(Tool::kFeel);
  options.workspace = Workspace(0.5, {100.0, 100.0, 0.0}, 0.5 * std::numbers::pi);  // away is left
  LoopChannels channels(options);
  LoopTick loop(std::make_unique<PreparedScene>(sceneWithBrush(0.0), start), start, device, channels,
                options);
  const auto tick = [&] {
    device.now_ns += 1'000'000;
    loop.run(device.now_ns, 1'000'000);
  };
  tick();
  EXPECT_FALSE(loop.state().stylus_axis);
  EXPECT_EQ(loop.state().device_mm, glm::dvec3(1.0, 2.0, 30.0));
  device.input.orientation =
      glm::angleAxis(0.5 * std::numbers::pi, glm::dvec3(-1.0, 0.0, 0.0));  // its z away
  tick();
  ASSERT_TRUE(loop.state().stylus_axis);
  EXPECT_LT(glm::length(*loop.state().stylus_axis - glm::dvec3(-1.0, 0.0, 0.0)), 1e-12);
  device.input.link = LinkState::kDisconnected;
  tick();
  EXPECT_FALSE(loop.state().stylus_axis);
}

}  // namespace
}  // namespace fettle::haptic
