// Passivity in closed loop with a simulated hand: nothing comes out, on any of the hard surfaces.
#include "haptic/effects/passivity.h"

#include <cstdio>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "haptic/devices/virtual/simulated_hand.h"
#include "tests/haptic/effects/touch.h"

namespace fettle::haptic {
namespace {

using tests::fieldOf;
using tests::HeldMass;
using tests::sceneOf;
using tests::Touch;

constexpr int kSide = 128;
constexpr double kSpacing = 0.1;

struct HardSurface {
  const char* name;
  engine::Version field;
};

std::vector<HardSurface> hardSurfaces() {
  const auto of = [](auto&& z) { return fieldOf(kSide, kSide, z, kSpacing, kSpacing); };
  std::mt19937_64 random(3);
  return {{"flat", of([](int, int) { return 0.0; })},
          {"step", of([](int c, int) { return c < kSide / 2 ? 0.0 : 1.0; })},
          {"ridge one sample wide", of([](int c, int) { return c == kSide / 2 ? 1.0 : 0.0; })},
          {"concave corner", of([](int c, int) { return 0.1 * std::abs(c - kSide / 2); })},
          // Ten times the noise of the scanner's default, 0.02 mm.
          {"noise x 10", of([&](int, int) { return fettle::tests::uniform(random, -0.35, 0.35); })}};
}

// Presses in the middle, where the hard part is, drags across it and along it, and lifts.
std::vector<HandTarget> path() {
  const double m = 0.5 * kSide * kSpacing;
  return {{0.0, {m, m, 3.0}},      {0.3, {m, m, -3.0}},         {1.0, {m, m, -3.0}},
          {2.0, {m + 3, m, -3.0}}, {3.0, {m - 3, m + 1, -3.0}}, {4.0, {m, m + 3, -2.0}},
          {4.5, {m, m, -2.0}},     {5.0, {m, m, 3.0}},          {5.5, {m, m, 3.0}}};
}

struct Outcome {
  double work_mj = 0.0;  ///< at the end
  double most_mj = 0.0;  ///< at any time
  double observed_mj = 0.0;
  double fastest_mm_s = 0.0;  ///< while pressed at rest, 0.7 s to 1 s
  std::int64_t acted = 0;
  std::int64_t contacts = 0;
};

Outcome press(const engine::Version& field, Scene scene, double rate_hz, const HandSpec& light = {}) {
  HandSpec spec = light;
  spec.rate_hz = rate_hz;
  SimulatedHand hand(path(), spec);
  engine::LiveField live(field, engine::Growth::kAllowed);
  Tick tick(scene, live, field);
  Outcome out;
  while (!hand.finished()) {
    const glm::dvec3 at = hand.read().position_mm;
    const ForceSample felt = tick.run({hand.seconds(), at, Tool::kFeel});
    hand.write(felt.force_n);
    EXPECT_LE(glm::length(felt.force_n), scene.force_limit_n * (1 + 1e-12));
    out.most_mj = std::max(out.most_mj, hand.workOnHandMj());
    out.contacts += felt.contact ? 1 : 0;
    if (hand.seconds() > 0.7 && hand.seconds() < 1.0)
      out.fastest_mm_s = std::max(out.fastest_mm_s, glm::length(hand.velocityMmS()));
  }
  out.work_mj = hand.workOnHandMj();
  out.observed_mj = tick.counters().work_on_hand_mj;
  out.acted = tick.counters().passivity_ticks;
  return out;
}

// A hand of 0.15 kg that damps 0.003 N s/mm itself on 20 N/mm: K T / 2 = 0.01 at 1 kHz, 0.005 at 2 kHz.
TEST(Passivity, NoNetEnergyComesOutWhereWithoutItTheWallBuzzes) {
  for (const HardSurface& surface : hardSurfaces())
    for (const double rate : {1000.0, 2000.0}) {
      Scene scene = sceneOf({EffectKind::kSpring});
      scene.stiffness_n_per_mm = 20.0;
      const Outcome without = press(surface.field, scene, rate);
      scene.effects.push_back(EffectKind::kPassivity);
      const Outcome with = press(surface.field, scene, rate);
      std::printf(
          "%-24s %5.0f Hz: without %9.2f mJ, with %9.2f mJ (most %5.2f, observed %9.2f, acted %lld)\n",
          surface.name, rate, without.work_mj, with.work_mj, with.most_mj, with.observed_mj,
          static_cast<long long>(with.acted));
      // The controller's forecast is the last step once more; acceleration makes the next one longer by at
      // most (F_max + F_hand) / m T^2. F_max = 8 N; the hand pulls with 0.3 N/mm over at most 8 mm and damps
      // 0.003 N s/mm at 500 mm/s, 4 N in all; so 8 N * 12 N / 0.15 kg * T^2 = 0.64 mJ at 1 kHz.
      const double tolerance = 0.64e6 / (rate * rate);
      EXPECT_GT(without.work_mj, 10.0 * tolerance) << surface.name << ' ' << rate;
      EXPECT_LE(with.work_mj, tolerance) << surface.name << ' ' << rate;
      EXPECT_LE(with.most_mj, tolerance) << surface.name << ' ' << rate;
      EXPECT_LT(with.fastest_mm_s, without.fastest_mm_s) << surface.name << ' ' << rate;
      EXPECT_GT(with.contacts, 1000);
    }
}

TEST(Passivity, TheObserverSeesExactlyTheWorkDone) {
  Scene scene = sceneOf({EffectKind::kSpring, EffectKind::kPassivity});
  scene.stiffness_n_per_mm = 10.0;
  const Outcome out = press(hardSurfaces()[3].field, scene, 1000.0);
  // The same sum in other order: 5500 ticks of 100 substeps, roundings of 1e2 mJ.
  EXPECT_NEAR(out.observed_mj, out.work_mj, 1e-9);
}

TEST(Passivity, LeavesAWallAloneThatIsStable) {
  Scene scene = sceneOf({EffectKind::kSpring});
  const Outcome without = press(hardSurfaces()[0].field, scene, 1000.0);
  scene.effects.push_back(EffectKind::kPassivity);
  const Outcome with = press(hardSurfaces()[0].field, scene, 1000.0);
  EXPECT_LT(with.acted, with.contacts / 50);
  EXPECT_NEAR(with.work_mj, without.work_mj, 0.1);
}

TEST(Passivity, EverythingTogetherStaysPassive) {
  for (const HardSurface& surface : hardSurfaces()) {
    Scene scene = sceneOf({EffectKind::kSpring, EffectKind::kFriction, EffectKind::kTexture,
                           EffectKind::kViscosity, EffectKind::kCoupling, EffectKind::kPassivity});
    scene.stiffness_n_per_mm = 20.0;
    const Outcome out = press(surface.field, scene, 1000.0);
    EXPECT_LE(out.work_mj, 0.64) << surface.name;
    EXPECT_LE(out.most_mj, 0.64) << surface.name;
  }
}

TEST(Passivity, DoesNotCountWhatHoldsUpTheStylus) {
  const engine::Version flat = fieldOf(20, 20, [](int, int) { return 0.0; });
  Scene scene = sceneOf({EffectKind::kGravity, EffectKind::kPassivity});
  scene.params.gravity.stylus_kg = 0.1;
  Touch touch(flat, scene);
  for (int i = 0; i < 1000; ++i) ASSERT_NEAR(touch.at({5.0, 5.0, 10.0 + 0.1 * i}).force_n.z, 0.980665, 1e-12);
  EXPECT_EQ(touch.tick.counters().passivity_ticks, 0);
  EXPECT_EQ(touch.tick.counters().work_on_hand_mj, 0.0);
}

TEST(Passivity, BrakesNoHarderThanItsDampingAndNeverAcrossTheMotion) {
  const engine::Version flat = fieldOf(20, 20, [](int, int) { return 0.0; });
  Scene scene = sceneOf({EffectKind::kSpring, EffectKind::kPassivity});
  scene.params.passivity.max_damping_n_s_per_mm = 0.004;
  Touch touch(flat, scene);
  // Starts deep inside, as after an adoption: nobody put that energy in. Moves out at 100 mm/s.
  static_cast<void>(touch.at({5.0, 5.0, -2.0}));
  for (int i = 1; i < 20; ++i) {
    const ForceSample f = touch.at({5.0, 5.0 + 0.01 * i, -2.0 + 0.1 * i});
    const glm::dvec3 along = glm::normalize(glm::dvec3(0.0, 0.01, 0.1));
    const glm::dvec3 spring{0.0, 0.0, 2.0 - 0.1 * i};
    EXPECT_GE(glm::dot(f.force_n, along), -0.004 * 100.6);
    EXPECT_LE(glm::dot(f.force_n, along), 1e-12);
    const glm::dvec3 changed = f.force_n - spring;
    EXPECT_LT(glm::length(changed - glm::dot(changed, along) * along), 1e-9);
  }
}

TEST(Passivity, HardInputsKeepItFiniteAndQuiet) {
  const engine::Version flat = fieldOf(20, 20, [](int, int) { return 0.0; });
  Touch touch(flat, sceneOf({EffectKind::kSpring, EffectKind::kPassivity}));
  std::mt19937_64 random(1);
  for (int i = 0; i < 20000; ++i) {
    glm::dvec3 e{fettle::tests::uniform(random, 0, 19), fettle::tests::uniform(random, 0, 19),
                 fettle::tests::uniform(random, -3, 1)};
    if (i % 100 == 0) e.z = std::nan("");
    if (i % 100 == 10) e.z = -1e300;
    if (i % 100 == 11) e.z = 5e-324;
    if (i % 100 == 20) touch.tick.fieldChanged();
    ASSERT_LE(glm::length(touch.at(e).force_n), 8.0 * (1 + 1e-12));
    // Jumps are not counted: what is left are steps of a hand, 5 mm at 8 N each at most.
    ASSERT_LE(std::abs(touch.tick.counters().work_on_hand_mj), 40.0 * (i + 1)) << i;
  }
}

}  // namespace
}  // namespace fettle::haptic
