// What a tick measures for the ear, and that it changes nothing of what is felt.
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "haptic/sound/synthesiser.h"
#include "haptic/tick/replay.h"
#include "haptic/trials/hand_stroke.h"
#include "tests/haptic/effects/touch.h"
#include "tests/haptic/loop/hand_device.h"
#include "tests/haptic/sound/spectrum.h"

namespace fettle::haptic {
namespace {

using tests::fieldOf;
using tests::sceneOf;
using tests::Touch;

// Ridges along y: 10 samples a period, 0.05 mm apart, 0.02 mm high.
engine::Version ridged() {
  return fieldOf(
      1500, 20, [](int c, int) { return 0.01 * std::sin(2.0 * std::numbers::pi * c / 10.0); }, 0.05, 0.05);
}

Scene sounding(std::vector<EffectKind> others = {}) {
  others.insert(others.begin(), EffectKind::kSpring);
  others.push_back(EffectKind::kSound);
  return sceneOf(others);
}

TEST(HeardTick, RidgesUnderAHandAreHeardAtItsSpeedOverTheirPitch) {
  for (const double speed_mm_s : {25.0, 50.0}) {
    Touch touch(ridged(), sounding());
    Synthesiser synthesiser{SoundParams{}};
    std::vector<float> sound(1000 * 48);
    for (std::size_t i = 0; i < 1000; ++i) {
      touch.at({5.0 + 1e-3 * speed_mm_s * static_cast<double>(i), 0.5, -0.2});
      ASSERT_TRUE(touch.tick.heard()->contact);
      synthesiser.render(*touch.tick.heard(), std::span(sound).subspan(48 * i, 48));
    }
    const std::span<const float> steady = std::span<const float>(sound).subspan(24000);
    EXPECT_NEAR(tests::peakHz(steady, 10.0, 1000.0, 1.0), speed_mm_s / 0.5, 2.0) << speed_mm_s;
    EXPECT_GT(tests::rms(steady), 0.005);
  }
}

TEST(HeardTick, ItsRisesAddUpToTheHeightPassed) {
  const engine::Version slope = fieldOf(300, 20, [](int c, int) { return 0.3 * c; });
  Touch touch(slope, sounding());
  touch.at({100.0, 10.0, 29.0});
  double rise = 0.0;
  const double before = touch.tick.contact().proxy.position_mm.z;
  for (int i = 1; i <= 50; ++i) {
    touch.at({100.0 + 0.7 * i, 10.0, 29.0 + 0.7 * 0.3 * i});
    for (const float r : touch.tick.heard()->rise_cells) rise += static_cast<double>(r);
    EXPECT_NEAR(touch.tick.heard()->speed_cells_s, 700.0, 1.0);
  }
  EXPECT_NEAR(rise, touch.tick.contact().proxy.position_mm.z - before, 1e-4);
}

TEST(HeardTick, AnotherScaleOfTheScanSoundsTheSame) {
  // Metres instead of millimetres: the same numbers, in cells.
  const auto bumps = [](int c, int r) { return 0.1 * ((7 * c + 3 * r) % 5); };
  const engine::Version fine = fieldOf(80, 80, bumps);
  const engine::Version coarse = fieldOf(
      80, 80, [&](int c, int r) { return 1024.0 * bumps(c, r); }, 1024.0, 1024.0);
  Touch one(fine, sounding());
  Scene softer = sounding();
  softer.stiffness_n_per_mm /= 1024.0;
  Touch other(coarse, softer);
  for (int i = 0; i < 500; ++i) {
    const glm::dvec3 tip{10.0 + 0.1 * i, 20.0 + 0.03 * i, i % 100 < 90 ? -0.3 : 3.0};
    one.at(tip);
    other.at(1024.0 * tip);
    const SoundTick &a = *one.tick.heard(), &b = *other.tick.heard();
    ASSERT_EQ(a.contact, b.contact);
    ASSERT_NEAR(a.speed_cells_s, b.speed_cells_s, 1e-3);
    ASSERT_NEAR(a.approach_cells_s, b.approach_cells_s, 1e-2);
    ASSERT_NEAR(a.strength, b.strength, 1e-6);
    for (std::size_t k = 0; k < a.rise_cells.size(); ++k) ASSERT_NEAR(a.rise_cells[k], b.rise_cells[k], 1e-5);
  }
}

TEST(HeardTick, ContactBeginsWithTheSpeedIntoTheSurfaceAndOnlyThen) {
  Touch touch(tests::flat(), sounding());
  int knocks = 0;
  for (int i = 0; i < 200; ++i) {
    touch.at({20.0, 20.0, std::max(5.0 - 0.1 * i, -1.0)});
    const SoundTick& heard = *touch.tick.heard();
    if (heard.approach_cells_s == 0.0F) continue;
    ++knocks;
    EXPECT_NEAR(heard.approach_cells_s, 100.0, 1e-6);
  }
  EXPECT_EQ(knocks, 1);
  touch.at({20.0, 20.0, 5.0});
  EXPECT_FALSE(touch.tick.heard()->contact);
}

TEST(HeardTick, FrictionThatLetsGoIsMarkedOnceAndSlidingWhileItLasts) {
  Touch touch(tests::flat(), sounding({EffectKind::kFriction}));
  int released = 0, sliding = 0;
  for (int i = 0; i < 400; ++i) {
    touch.at({5.0 + 0.02 * std::min(i, 200), 20.0, -2.0});
    released += touch.tick.heard()->released > 0.0F ? 1 : 0;
    sliding += touch.tick.heard()->slipping ? 1 : 0;
    if (touch.tick.heard()->released > 0.0F) {
      EXPECT_NEAR(touch.tick.heard()->released, (0.4 - 0.3) * 2.0 / 8.0, 1e-6);
    }
  }
  EXPECT_EQ(released, 1);
  EXPECT_GT(sliding, 100);
  EXPECT_LT(sliding, 300) << "a tip at rest sticks again";
}

TEST(HeardTick, TheReliefOfATextureIsHeardWhereverTheSceneListsIt) {
  for (const bool after : {false, true}) {
    Scene scene = sceneOf({EffectKind::kSpring, EffectKind::kTexture, EffectKind::kSound});
    if (after) std::swap(scene.effects[1], scene.effects[2]);
    scene.params.texture.pattern = TexturePattern::kGrating;
    Touch touch(tests::flat(), scene);
    touch.at({10.0, 10.0, -0.5});
    double most = 0.0;
    for (int i = 0; i < 100; ++i) {
      touch.at({10.0 + 0.05 * i, 10.0, -0.5});
      for (const float r : touch.tick.heard()->rise_cells)
        most = std::max(most, std::abs(static_cast<double>(r)));
    }
    EXPECT_GT(most, 1e-4) << after;
  }
}

TEST(HeardTick, NothingIsHeardOfAFieldThatIsReplacedOrOfInputThatIsLost) {
  Touch touch(ridged(), sounding());
  for (int i = 0; i < 10; ++i) touch.at({5.0 + 0.05 * i, 0.5, -0.2});
  touch.tick.fieldChanged();
  touch.at({6.0, 0.5, -0.2});
  for (const float r : touch.tick.heard()->rise_cells) EXPECT_EQ(r, 0.0F);
  EXPECT_TRUE(touch.tick.heard()->contact);
  touch.at({std::nan(""), 0.5, -0.2});
  EXPECT_FALSE(touch.tick.heard()->contact);
  touch.at({6.2, 0.5, -0.2});
  EXPECT_TRUE(touch.tick.heard()->contact);
  for (const float r : touch.tick.heard()->rise_cells) EXPECT_EQ(r, 0.0F);
  EXPECT_EQ(touch.tick.heard()->approach_cells_s, 0.0F) << "of a tip whose way is not known";
}

TEST(HeardTick, HolesWallsAndJumpsGiveFiniteTicks) {
  std::mt19937_64 random(11);
  for (int kind = 0; kind < 6; ++kind) {
    const engine::Version field = fettle::tests::randomField(random, 60, 60, kind, 0.3, 0.7, 0.05);
    Touch touch(field, sounding({EffectKind::kFriction, EffectKind::kTexture}));
    for (int i = 0; i < 20000; ++i) {
      const auto near = [&](double low, double high) { return fettle::tests::uniform(random, low, high); };
      const double jump = i % 50 == 0 ? 40.0 : 0.5;
      static thread_local glm::dvec3 at{5.0, 5.0, 0.0};
      at.x = std::clamp(at.x + near(-jump, jump), -1.0, 19.0);
      at.y = std::clamp(at.y + near(-jump, jump), -1.0, 43.0);
      at.z = near(-5.0, 3.0);
      touch.at(i % 701 == 0 ? glm::dvec3(std::nan("")) : at);
      const SoundTick& heard = *touch.tick.heard();
      ASSERT_TRUE(std::isfinite(heard.speed_cells_s) && std::isfinite(heard.approach_cells_s));
      ASSERT_TRUE(heard.strength >= 0.0F && heard.strength <= 1.0F);
      for (const float r : heard.rise_cells) ASSERT_TRUE(std::isfinite(r));
    }
  }
}

TEST(HeardTick, WithSoundEveryForceAndSampleIsTheSameToTheBit) {
  const engine::Version field = trials::workpiece(200, 0.05);
  trials::HandMotion motion;
  motion.ticks = 20000;
  std::vector<StrokeSample> strokes = trials::handStroke(field, motion);
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    strokes[i].tool = static_cast<Tool>(i / 700 % kTools);
    if (i % 3001 == 5) strokes[i].tip_mm.y = std::nan("");
  }
  std::vector<EffectKind> kinds;
  for (int k = 0; k < static_cast<int>(EffectKind::kSound); ++k) kinds.push_back(static_cast<EffectKind>(k));
  for (const std::vector<EffectKind>& effects :
       {std::vector{EffectKind::kSpring, EffectKind::kSmoothing}, kinds}) {
    Scene without = sceneOf(effects);
    Scene with = without;
    with.effects.push_back(EffectKind::kSound);
    engine::JobControl job;
    const auto a = replay(field, field, strokes, without, {RecordForces::kYes, MeasureContact::kNo}, job);
    const auto b = replay(field, field, strokes, with, {RecordForces::kYes, MeasureContact::kNo}, job);
    ASSERT_TRUE(a && b);
    EXPECT_EQ(engine::contentHash(a->field), engine::contentHash(b->field));
    for (std::size_t i = 0; i < strokes.size(); ++i)
      ASSERT_EQ(a->forces[i].force_n, b->forces[i].force_n) << i;
  }
}

TEST(HeardTick, TheLoopSendsWhatItHearsAndNothingOfASceneWithoutSound) {
  const engine::Version field = ridged();
  LoopOptions options;
  tests::HandDevice device;
  LoopChannels channels(options);
  const auto ring = std::make_shared<SoundRing>(64);
  LoopTick loop(std::make_unique<PreparedScene>(sounding(), field, ring), field, device, channels, options);
  const auto tick = [&](double x) {
    device.input.position_mm = {x, 0.5, -0.2};
    device.now_ns += 1'000'000;
    loop.run(device.now_ns, 1'000'000);
  };
  for (int i = 0; i < 100; ++i) tick(5.0 + 0.03 * i);
  EXPECT_EQ(ring->waiting(), 64U) << "a full ring stops nobody";
  SoundTick heard;
  while (ring->pop(heard)) EXPECT_NEAR(heard.seconds, 1e-3, 1e-9);
  EXPECT_TRUE(heard.contact);
  EXPECT_GT(heard.speed_cells_s, 100.0F);
  // Another scene, with the same ring but without the effect.
  LoopCommand command;
  command.kind = CommandKind::kScene;
  command.scene = std::make_unique<PreparedScene>(sceneOf({EffectKind::kSpring}), field, ring);
  ASSERT_TRUE(channels.commands.push(std::move(command)));
  for (int i = 0; i < 10; ++i) tick(8.0 + 0.03 * i);
  EXPECT_EQ(ring->waiting(), 0U);
}

}  // namespace
}  // namespace fettle::haptic
