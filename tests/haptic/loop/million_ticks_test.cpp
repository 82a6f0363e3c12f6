// What must hold for every one of a million ticks.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "haptic/devices/virtual/controller_stylus.h"
#include "haptic/sound/sound_stream.h"
#include "tests/haptic/loop/allocation_guard.h"
#include "tests/haptic/loop/hand_device.h"
#include "tests/haptic/support/fields.h"

namespace fettle::haptic {
namespace {

using tests::LoopBench;
using tests::sweep;
using tests::testOptions;

constexpr int kMillionSide = 400;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr std::uint64_t kTicks = 100'000;  // ten times slower there
#else
constexpr std::uint64_t kTicks = 1'000'000;
#endif

engine::Version bumpyWithRidges() {
  return fettle::tests::fieldOf(kMillionSide, kMillionSide, [](int c, int r) {
    return 0.3 * std::sin(0.9 * c) * std::cos(0.7 * r) + (c % 97 == 0 ? 0.5 : 0.0);
  });
}

TEST(MillionTicks, NoneAllocatesWhateverToolBrushLevelEffectOrCommand) {
  if (!fettle::tests::allocationGuardWorks()) GTEST_SKIP() << "a sanitizer brings its own allocator";
  {
    // The guard itself: it must see what it is to forbid.
    const std::uint64_t before = fettle::tests::AllocationGuard::calls();
    const fettle::tests::AllocationGuard guard;
    void* volatile memory = std::malloc(8);
    EXPECT_EQ(memory, nullptr);
    EXPECT_EQ(fettle::tests::AllocationGuard::calls(), before + 1);
  }
  const engine::Version start = bumpyWithRidges();
  const auto& memory = start.memory();
  LoopBench bench(start, start, defaultScene(), testOptions(Tool::kSmooth));
  ASSERT_TRUE(bench.send(CommandKind::kArm));
  engine::Version undo_to = start;
  Scene scene_now = defaultScene();
  const auto sounds = std::make_shared<SoundRing>(1024);
  SoundStream stream(sounds, SoundParams{});
  std::array<float, 48> samples{};
  std::uint64_t adopted = 0, restored = 0, scenes = 0;
  const std::uint64_t calls_before = fettle::tests::AllocationGuard::calls();
  for (std::uint64_t i = 0; i < kTicks; ++i) {
    // The main side and the workers, who may allocate.
    if (i % 16 == 0) {
      ASSERT_TRUE(memory->tiles.reserve(1500) && memory->nodes.reserve(200));
      for (LoopEvent& event : bench.poll()) {
        adopted += event.kind == EventKind::kAdopted ? 1 : 0;
        restored += event.kind == EventKind::kRestored ? 1 : 0;
        scenes += event.kind == EventKind::kSceneChanged ? 1 : 0;
        if (event.kind == EventKind::kStrokeEnded) undo_to = event.version;
        if (event.kind == EventKind::kSnapshot) {
          engine::LiveField job(event.version, engine::Growth::kAllowed);
          ASSERT_TRUE(job.setHeight(static_cast<std::int32_t>(i * 7 % kMillionSide), 5, 0.25F));
          ASSERT_TRUE(bench.send(CommandKind::kAdopt, [&](LoopCommand& c) {
            c.id = event.id;
            c.version = job.snapshot();
          }));
        }
      }
    }
    if (i % 5000 == 100) {
      ASSERT_TRUE(bench.send(CommandKind::kSnapshot, [&](LoopCommand& c) { c.id = i; }));
    }
    if (i % 7000 == 50) {
      ASSERT_TRUE(bench.send(CommandKind::kRestore, [&](LoopCommand& c) {
        c.version = undo_to;
        // Under another form: with another original.
        if (i % 14000 == 50) c.scene = std::make_unique<PreparedScene>(scene_now, start, sounds);
      }));
    }
    if (i % 20000 == 10) {
      Scene& scene = scene_now;
      scene = defaultScene();
      const auto k = i / 20000;
      scene.level = static_cast<ContactLevel>(k % 3);
      scene.brush_radius_samples = static_cast<double>(k % 5) * 1.7;
      scene.mark_radius_samples = static_cast<double>(k % 4);
      scene.invert = k % 7 == 3;
      if (k % 3 == 0) scene.max_change = 0.1;
      // Every effect is in half of the scenes, each time next to others.
      for (int effect = static_cast<int>(EffectKind::kFriction); effect < kEffectKinds; ++effect)
        if (((k >> (effect % 3)) + static_cast<std::uint64_t>(effect)) % 2 == 0)
          scene.effects.push_back(static_cast<EffectKind>(effect));
      scene.params.viscosity.medium = k % 2 == 0 ? ViscousMedium::kEverywhere : ViscousMedium::kContact;
      ASSERT_TRUE(bench.send(CommandKind::kScene, [&](LoopCommand& c) {
        c.scene = std::make_unique<PreparedScene>(scene, start, sounds);
      }));
    }
    bench.device.input.tool = static_cast<Tool>(i / 300 % kTools);
    bench.device.input.position_mm = sweep(i, kMillionSide - 1.0, 0.1, 0.8);
    if (i % 3001 == 0) bench.device.input.position_mm.z = std::nan("");
    const fettle::tests::AllocationGuard guard;
    bench.tick(i % 997 == 0 ? 4'000'000 : LoopBench::kPeriod_ns);
    // Now and then nobody listens, and the ring is full.
    if (i / 3000 % 5 != 0) stream.fill(samples);
  }
  EXPECT_EQ(fettle::tests::AllocationGuard::calls(), calls_before);
  EXPECT_EQ(bench.loop.state().refused_edits, 0U);
  EXPECT_GT(adopted, kTicks / 10000);
  EXPECT_GT(restored, kTicks / 10000);
  EXPECT_GE(scenes, kTicks / 20000);
  EXPECT_GT(stream.counters().ticks, kTicks / 4) << "with sound, too";
  EXPECT_EQ(bench.loop.state().tick, kTicks);
}

// Mouse and controller in turn, as a person uses both: presses, jumps, questions, frames that stay away, hands that are no tip.
TEST(MillionTicks, NoneAllocatesWithAControllerInTheMousesPlace) {
  if (!fettle::tests::allocationGuardWorks()) GTEST_SKIP() << "a sanitizer brings its own allocator";
  const auto link = std::make_shared<ControllerLink>();
  ControllerStylus device{MouseFeel{}, link};
  std::int64_t now_ns = 1;
  ControllerHand hand;
  hand.tip = true;
  hand.reader = link->reader;
  std::uint64_t led = 0, pressed = 0, lifted = 0;
  const std::uint64_t calls_before = fettle::tests::AllocationGuard::calls();
  for (std::uint64_t i = 0; i < kTicks; ++i) {
    // The window's and the headset's side, who may allocate.
    if (i % 11 == 0) {
      const bool presses = i % 2000 < 1200;
      hand.press += (presses && !hand.pressed) || i % 7001 < 11 ? 1 : 0;
      hand.pressed = presses;
      hand.when_ns = now_ns;
      hand.position_mm = sweep(i, 100.0, 0.0, 1.0);
      link->asked = i % 50'000 > 45'000;
      if (i % 30'000 < 25'000) link->hand.publish(i % 9000 < 500 ? ControllerHand{} : hand);
    }
    if (i % 16 == 0) device.mouse().setCursor(sweep(i, 100.0, 0.0, 0.0));
    if (i % 40'000 == 26'000) device.mouse().press(Tool::kSmooth);
    if (i % 40'000 == 27'500) device.mouse().release();
    now_ns += i % 20'011 == 0 ? 2'500'000'000 : 1'000'000;
    const fettle::tests::AllocationGuard guard;
    const DeviceInput input = device.readAt(now_ns);
    device.show({!std::isnan(input.position_mm.x), input.position_mm, {0.0, 0.0, 1.0}, 0.5, now_ns});
    led += link->leads ? 1 : 0;
    pressed += link->leads && input.buttons != 0 ? 1 : 0;
    lifted += std::isnan(input.position_mm.x) ? 1 : 0;
  }
  EXPECT_EQ(fettle::tests::AllocationGuard::calls(), calls_before);
  EXPECT_GT(led, kTicks / 4);
  EXPECT_LT(led, kTicks - kTicks / 50) << "the mouse has its turn";
  EXPECT_GT(pressed, kTicks / 8);
  EXPECT_GT(lifted, kTicks / 2000);
}

// The proxy of every tick lies on the surface as the edits of the tick before left it, never below. The
// surface is kept a second time as a plain array and interpolated here.
TEST(MillionTicks, AfterAnEditUnderTheTipTheProxyIsOnTheSurfaceAtTheVeryNextTick) {
  const engine::Version start = bumpyWithRidges();
  ASSERT_TRUE(start.memory()->tiles.reserve(2000) && start.memory()->nodes.reserve(200));
  Scene scene = defaultScene();
  scene.brush_radius_samples = 1.5;
  LoopBench bench(start, start, scene, testOptions(Tool::kSmooth));
  tests::Mirror mirror(start);
  std::uint64_t contacts = 0, below = 0, above = 0;
  double worst = 0.0;
  for (std::uint64_t i = 0; i < kTicks; ++i) {
    const std::uint64_t pass = i / 50000;
    // Presses deeper and deeper, so that smoothing always has something to do; each pass on another track.
    const glm::dvec3 tip = sweep(i * (pass % 3 + 1) + 7919 * pass, kMillionSide - 1.0, 0.0, 0.9);
    bench.tickAt(tip);
    if (i % 64 == 0) static_cast<void>(bench.poll());
    if (!bench.loop.state().contact) continue;
    ++contacts;
    const glm::dvec3 p = bench.loop.state().proxy_mm;
    const int c = std::min(static_cast<int>(p.x), kMillionSide - 2);
    const int r = std::min(static_cast<int>(p.y), kMillionSide - 2);
    const double u = p.x - c;
    const double v = p.y - r;
    const auto h = [&](int dc, int dr) { return static_cast<double>(mirror.height(c + dc, r + dr)); };
    const double z =
        (1 - u) * (1 - v) * h(0, 0) + u * (1 - v) * h(1, 0) + (1 - u) * v * h(0, 1) + u * v * h(1, 1);
    // Heights below 1 mm, positions below 400 mm in double: 1e-12 holds all roundings.
    const double error = p.z - z;
    worst = std::max(worst, std::abs(error));
    below += error < -1e-12 ? 1 : 0;
    above += error > 1e-12 ? 1 : 0;
    const CellIndex cell = bench.loop.scene().tick.contact().proxy.cell;
    const std::int32_t c0 = std::max(cell.column - 2, 0);
    const std::int32_t r0 = std::max(cell.row - 2, 0);
    mirror.take(bench.field(),
                {c0, r0, std::min(c0 + 5, kMillionSide) - c0, std::min(r0 + 5, kMillionSide) - r0});
  }
  std::printf("%llu contact ticks of %llu, worst distance of the proxy to the surface %.1e mm\n",
              static_cast<unsigned long long>(contacts), static_cast<unsigned long long>(kTicks), worst);
  EXPECT_EQ(below, 0U);
  EXPECT_EQ(above, 0U);
  EXPECT_EQ(bench.loop.state().counters.below_without_contact, 0);
  EXPECT_GT(contacts, kTicks / 4);
  EXPECT_EQ(bench.loop.state().refused_edits, 0U);
}

}  // namespace
}  // namespace fettle::haptic
