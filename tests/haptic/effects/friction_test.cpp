// Friction: when it holds, when it slips, and that nothing comes out of it.
#include "haptic/effects/friction.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "tests/haptic/effects/touch.h"

namespace fettle::haptic {
namespace {

using tests::fieldOf;
using tests::HeldMass;
using tests::sceneOf;
using tests::Touch;
using tests::uniform;

Scene rough(double mu_static, double mu_dynamic, double stiffness) {
  Scene scene = sceneOf({EffectKind::kSpring, EffectKind::kFriction});
  scene.force_limit_n = 50.0;
  scene.params.friction = {mu_static, mu_dynamic, stiffness};
  return scene;
}

TEST(Friction, HoldsLikeASpringUpToTheStaticCoefficientAndSlidesWithTheDynamicOne) {
  // Pressed with 2 N: holds to 0.8 N (0.4 mm at 2 N/mm), then slides with 0.6 N.
  Touch touch(tests::flat(), rough(0.4, 0.3, 2.0));
  static_cast<void>(touch.at({10.0, 10.0, -2.0}));
  for (int i = 1; i <= 39; ++i)
    EXPECT_NEAR(touch.at({10.0 + 0.01 * i, 10.0, -2.0}).force_n.x, -0.02 * i, 1e-12) << i;
  for (int i = 41; i <= 100; ++i)
    EXPECT_NEAR(touch.at({10.0 + 0.01 * i, 10.0, -2.0}).force_n.x, -0.6, 1e-12) << i;
  // Turning back: the spring lets go first, then holds the other way.
  EXPECT_NEAR(touch.at({10.9, 10.0, -2.0}).force_n.x, -0.4, 1e-12);
  for (int i = 1; i <= 4; ++i) static_cast<void>(touch.at({10.9 - 0.1 * i, 10.0, -2.0}));
  EXPECT_NEAR(touch.at({10.35, 10.0, -2.0}).force_n.x, 0.7,
              1e-12);  // sticks again: above dynamic, below static
  EXPECT_NEAR(touch.at({10.2, 10.0, -2.0}).force_n.x, 0.6, 1e-12);  // and slips
}

TEST(Friction, ATipAtRestSticksAgain) {
  Touch touch(tests::flat(), rough(0.4, 0.3, 2.0));
  for (int i = 0; i <= 100; ++i) static_cast<void>(touch.at({10.0 + 0.01 * i, 10.0, -2.0}));
  for (int i = 0; i < 25; ++i) EXPECT_NEAR(touch.at({11.0, 10.0, -2.0}).force_n.x, -0.6, 1e-12);
  EXPECT_NEAR(touch.at({11.09, 10.0, -2.0}).force_n.x, -0.78, 1e-12);
}

// A tip pressed vertically on a slope slides down when the slope is steeper than atan(static).
TEST(Friction, SlipsOnASlopeExactlyAboveTheArcTangentOfTheStaticCoefficient) {
  const double mu = 0.5;
  for (const double slope : {0.46, 0.49, 0.51, 0.54}) {
    // 0.25 mm cells, anisotropic; slope along x, exact in float within 1e-8.
    const engine::Version field = fieldOf(
        400, 60, [&](int c, int) { return slope * 0.25 * c; }, 0.25, 1.5);
    Touch touch(field, rough(mu, 0.25, 1.0));
    HeldMass mass{0.1, 0.01};
    mass.x_mm = {80.0, 40.0, slope * 80.0};
    // Loaded slowly, so that nothing swings past the limit; then watched for a second.
    for (int i = 0; i < 6000; ++i) {
      const double load = std::min(i / 4000.0, 1.0);
      const glm::dvec3 force = touch.at(mass.x_mm).force_n - glm::dvec3(0.0, 0.0, load);
      mass.advance(force, touch.period_s);
    }
    // Held: 1 N on springs of 1 N/mm. Sliding: 1 N (sin - 0.25 cos) against 0.01 N s/mm, 20 mm/s and more.
    const double moved = 80.0 - mass.x_mm.x;
    if (slope < mu)
      EXPECT_LT(moved, 1.0) << slope;
    else
      EXPECT_GT(moved, 10.0) << slope;
  }
}

TEST(Friction, StickSlipDrawsAMassOnASpringInJerks) {
  // A mass drawn by a slow spring over a rough flat: between slips it stands.
  Touch touch(tests::flat(), rough(0.6, 0.2, 2.0));
  HeldMass mass{0.05, 0.003};
  mass.x_mm = {10.0, 20.0, -1.0};
  int slips = 0;
  bool was = false;
  for (int i = 0; i < 8000; ++i) {
    const glm::dvec3 pull{0.3 * (10.0 + 0.002 * i - mass.x_mm.x), 0.0, -1.0};
    const ForceSample sample = touch.at(mass.x_mm);
    mass.advance(sample.force_n + pull, touch.period_s);
    const auto& friction = *static_cast<const Friction*>(touch.tick.effects().data[1].memory.get());
    slips += friction.slipping() && !was ? 1 : 0;
    was = friction.slipping();
  }
  EXPECT_GE(slips, 3);
  EXPECT_LE(slips, 40);
  EXPECT_GT(mass.x_mm.x, 18.0);
}

// With the force at the end of each step, as the energy argument has it: over any walk on any surface, at any
// press, nothing comes out. Exact but for roundings of 1e5 terms of size 1e-2.
TEST(Friction, NoEnergyComesOutOverAnyWalkOnAnySurface) {
  std::mt19937_64 random(5);
  for (int kind = 0; kind < 6; ++kind) {
    const engine::Version field = fettle::tests::randomField(random, 60, 60, kind, 0.3, 0.7);
    Scene scene = rough(0.7, 0.4, 3.0);
    scene.force_limit_n = 1000.0;
    Friction friction(scene.params.friction);
    Touch touch(field, sceneOf({EffectKind::kSpring}));
    TickCounters counters;
    glm::dvec3 e{9.0, 20.0, -1.0}, v{0.0};
    glm::dvec3 before = e;
    double out_mj = 0.0;
    int slipping = 0;
    for (int i = 0; i < 20000; ++i) {
      for (int k = 0; k < 3; ++k) v[k] = 0.98 * v[k] + uniform(random, -0.004, 0.004);
      e += v;
      for (int k = 0; k < 2; ++k)
        if (e[k] < 1.0 || e[k] > 16.0) v[k] = -v[k];
      e.z = std::clamp(e.z, -3.0, -0.1);
      if (!touch.at(e).contact) {
        friction.reset();
        before = e;
        continue;
      }
      const Contact contact = touch.tick.contact();
      TickState state{contact, touch.field, touch.tick.surface(), counters};
      state.t_s = 1e-3 * i;
      state.endpoint_mm = e;
      state.force_limit_n = scene.force_limit_n;
      state.press_n = contact.penetration_mm;
      friction.run(state);
      out_mj += glm::dot(state.force_n, e - before);
      before = e;
      slipping += friction.slipping() ? 1 : 0;
      ASSERT_LE(out_mj, 1e-9) << "field " << kind << " tick " << i;
    }
    EXPECT_LT(out_mj, -1.0);
    EXPECT_GT(slipping, 100);
  }
}

TEST(Friction, TheAnchorDoesNotDriftUnderTremorOnAPlane) {
  const engine::Version field = fieldOf(60, 60, [](int c, int r) { return 0.25 * c - 0.125 * r; });
  Touch touch(field, rough(0.5, 0.4, 4.0));
  const auto& friction = *static_cast<const Friction*>(touch.tick.effects().data[1].memory.get());
  const glm::dvec3 rest{20.2, 31.3, 0.25 * 20.2 - 0.125 * 31.3 - 1.5};
  static_cast<void>(touch.at(rest));
  std::mt19937_64 random(8);
  for (int i = 0; i < 100000; ++i)
    static_cast<void>(touch.at(rest + glm::dvec3(uniform(random, -0.02, 0.02), uniform(random, -0.02, 0.02),
                                                 uniform(random, -0.02, 0.02))));
  static_cast<void>(touch.at(rest));
  EXPECT_FALSE(friction.slipping());
  // Each tick rounds positions near 30 mm a few times, and normals, which move the anchor by the depth.
  EXPECT_LT(glm::length(friction.anchorMm() - rest), 1e-9);
}

TEST(Friction, NothingYanksAfterJumpsDropoutsAdoptionsAndLifting) {
  Touch touch(tests::flat(), rough(0.4, 0.3, 2.0));
  const auto side = [](const ForceSample& f) { return std::hypot(f.force_n.x, f.force_n.y); };
  static_cast<void>(touch.at({5.0, 5.0, -1.0}));
  // A jump within contact: at most what friction may be.
  EXPECT_LE(side(touch.at({30.0, 30.0, -1.0})), 0.4 * 1.0 + 1e-12);
  EXPECT_NEAR(side(touch.at({std::nan(""), 30.0, -1.0})), 0.0, 0.0);
  EXPECT_EQ(side(touch.at({5.0, 5.0, -1.0})), 0.0);
  static_cast<void>(touch.at({5.1, 5.0, -1.0}));
  touch.tick.fieldChanged();
  EXPECT_EQ(side(touch.at({5.2, 5.0, -1.0})), 0.0);
  static_cast<void>(touch.at({5.3, 5.0, 1.0}));
  EXPECT_EQ(side(touch.at({9.0, 5.0, -1.0})), 0.0);
  // Deep beyond the force limit: friction goes by the limit, not by a thousand kilometres of spring.
  Scene scene = rough(0.4, 0.3, 1000.0);
  scene.force_limit_n = 3.0;
  Touch deep(tests::flat(), scene);
  static_cast<void>(deep.at({5.0, 5.0, -1e6}));
  const ForceSample f = deep.at({15.0, 5.0, -1e6});
  EXPECT_LE(glm::length(f.force_n), 3.0 * (1 + 1e-12));
  EXPECT_NEAR(f.force_n.x / f.force_n.z, 0.0, 0.3 * 3.0 / 1e6 * 1.01);
}

// The stated condition, b > k T / 2, of the stuck tip: a mass on a device with damping b, pressed at a depth
// that is held, kicked a little along the surface.
TEST(Friction, StuckTipIsStableUpToTwiceTheDampingOverThePeriod) {
  const double b = 0.002;
  for (const double rate : {1000.0, 4000.0}) {
    const double theory = 2.0 * b * rate;
    for (const double factor : {0.9, 1.12}) {
      Touch touch(tests::flat(), rough(2.0, 2.0, factor * theory), rate);
      HeldMass mass{0.1, b};
      mass.x_mm = {20.3, 20.3, -5.0};
      static_cast<void>(touch.at(mass.x_mm));
      mass.x_mm.x += 1e-3;
      double early = 0.0, late = 0.0;
      const int ticks = static_cast<int>(rate);
      for (int i = 0; i < ticks; ++i) {
        const glm::dvec3 force = touch.at(mass.x_mm).force_n;
        mass.advance({force.x, 0.0, 0.0}, touch.period_s);
        double& most = i < ticks / 10 ? early : late;
        if (i < ticks / 10 || i > ticks * 9 / 10) most = std::max(most, std::abs(mass.x_mm.x - 20.3));
      }
      EXPECT_EQ(late < early, factor < 1.0) << rate << ' ' << factor << ' ' << early << ' ' << late;
    }
  }
}

}  // namespace
}  // namespace fettle::haptic
