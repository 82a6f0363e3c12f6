// Velocity, viscosity, virtual coupling, gravity.
#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "tests/haptic/effects/touch.h"

namespace fettle::haptic {
namespace {

using tests::HeldMass;
using tests::sceneOf;
using tests::Touch;
using tests::uniform;

TEST(Velocity, SteadyMotionIsReadExactlyAndAStepWithTheStatedLag) {
  VelocityFilter filter(0.002);
  for (int i = 0; i < 200; ++i) filter.update(1e-3 * i, {0.05 * i, -0.01 * i, 3.0});
  // (2/3)^199 of the start is left, and roundings of positions near 10 over 1 ms.
  EXPECT_LT(glm::length(filter.mmPerS() - glm::dvec3(50.0, -10.0, 0.0)), 1e-10);
  // On a ramp of speed the estimate lags by T / 2 + tau: 2.5 ms.
  VelocityFilter ramp(0.002);
  double t = 0.0;
  for (int i = 0; i < 500; ++i) {
    t = 1e-3 * i;
    ramp.update(t, {0.5 * 1000.0 * t * t, 0.0, 0.0});
  }
  EXPECT_NEAR(ramp.mmPerS().x, 1000.0 * (t - 0.0025), 1e-6);
}

TEST(Velocity, IsZeroAfterWhateverIsNoMeasureOfSpeed) {
  for (const auto& [t, x] : {std::pair{0.002, 1e6},
                             {0.001, 0.01},
                             {0.0005, 0.01},
                             {0.5, 0.01},
                             {static_cast<double>(NAN), 0.01},
                             {HUGE_VAL, 0.01},
                             {0.002, 1e308},
                             {0.002, -1e308}}) {
    VelocityFilter filter(0.002);
    filter.update(0.0, {0.0, 0.0, 0.0});
    filter.update(0.001, {0.02, 0.0, 0.0});
    EXPECT_GT(filter.mmPerS().x, 1.0);
    filter.update(t, {x, 0.0, 0.0});
    EXPECT_EQ(filter.mmPerS(), glm::dvec3(0.0)) << t << ' ' << x;
    EXPECT_EQ(filter.dt(), 0.0);
  }
  // A hand of 100 mm/s on a field of kilometres, which is no jump.
  VelocityFilter wide(0.0, 1e9);
  wide.update(0.0, {0.0, 0.0, 0.0});
  wide.update(0.001, {1e4, 0.0, 0.0});
  EXPECT_NEAR(wide.mmPerS().x, 1e7, 1.0);
  wide.update(0.002, {2e6, 0.0, 0.0});
  EXPECT_EQ(wide.mmPerS(), glm::dvec3(0.0));
  VelocityFilter small(0.0);
  small.update(0.0, {0.0, 0.0, 0.0});
  small.update(0.001, {5e-324, 0.0, 0.0});
  EXPECT_TRUE(std::isfinite(small.mmPerS().x));
}

Scene viscous(double b, double filter_ms = 2.0) {
  Scene scene = sceneOf({EffectKind::kViscosity});
  scene.params.viscosity = {b, ViscousMedium::kEverywhere};
  scene.params.velocity.filter_ms = filter_ms;
  return scene;
}

TEST(Viscosity, TerminalForceIsDampingTimesSpeedAndStopsWithTheHand) {
  Touch touch(tests::flat(), viscous(0.003));
  ForceSample f;
  for (int i = 0; i < 200; ++i) f = touch.at({5.0 + 0.06 * i, 5.0 + 0.03 * i, 10.0 - 0.02 * i});
  EXPECT_FALSE(f.contact);
  // Settled to (2/3)^199 of it; roundings of positions near 20 over 1 ms, times b.
  EXPECT_LT(glm::length(f.force_n - glm::dvec3(-0.18, -0.09, 0.06)), 1e-12);
  const glm::dvec3 rest = f.proxy_mm;
  for (int i = 0; i < 100; ++i) f = touch.at(rest);
  EXPECT_LT(glm::length(f.force_n), 1e-15);
}

TEST(Viscosity, OnlyWhereTheMediumIs) {
  Scene scene = viscous(0.003);
  scene.params.viscosity.medium = ViscousMedium::kContact;
  Touch touch(tests::flat(), scene);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(touch.at({5.0 + 0.1 * i, 5.0, 1.0}).force_n, glm::dvec3(0.0));
  EXPECT_LT(touch.at({7.1, 5.0, -0.1}).force_n.x, -0.1);
}

TEST(Viscosity, JumpsDropoutsAndSpikesGiveNoKick) {
  Touch touch(tests::flat(), viscous(0.01));
  static_cast<void>(touch.at({5.0, 5.0, 1.0}));
  EXPECT_EQ(touch.at({1e6, 5.0, 1.0}).force_n, glm::dvec3(0.0));
  EXPECT_EQ(touch.at({HUGE_VAL, 5.0, 1.0}).force_n, glm::dvec3(0.0));
  EXPECT_EQ(touch.at({5.0, 5.0, 1.0}).force_n, glm::dvec3(0.0));
  touch.t_s += 0.5;
  EXPECT_EQ(touch.at({5.1, 5.0, 1.0}).force_n, glm::dvec3(0.0));
  EXPECT_LT(touch.at({5.2, 5.0, 1.0}).force_n.x, 0.0);
}

// Free mass in the medium: stable exactly below 2 m / T, whatever the filter and the rate.
TEST(Viscosity, IsStableExactlyBelowTwoMassesOverThePeriod) {
  for (const double rate : {1000.0, 5000.0})
    for (const double filter_ms : {0.0, 2.0})
      for (const double factor : {0.97, 1.03}) {
        Scene scene = viscous(1.0, filter_ms);
        HeldMass mass{0.02};
        const double bound = 2.0 * mass.mass_kg * 1e-3 * rate;  // [N s/mm]: 0.04 and 0.2
        scene.params.viscosity.damping_n_s_per_mm = factor * bound;
        ASSERT_FALSE(sceneProblem(scene));
        scene.force_limit_n = 1000.0;
        Touch touch(tests::flat(), scene, rate);
        mass.x_mm = {20.0, 20.0, 5.0};
        mass.v_mm_s.x = 1e-3;
        double early = 0.0, late = 0.0;
        for (int i = 0; i < 600; ++i) {
          mass.advance(touch.at(mass.x_mm).force_n, touch.period_s);
          double& most = i < 100 ? early : late;
          if (i < 100 || i >= 500) most = std::max(most, std::abs(mass.v_mm_s.x));
        }
        EXPECT_EQ(late < early, factor < 1.0) << rate << ' ' << filter_ms << ' ' << factor;
      }
}

Scene coupled(double stiffness, double b, double filter_ms) {
  Scene scene = sceneOf({EffectKind::kSpring, EffectKind::kCoupling});
  scene.stiffness_n_per_mm = stiffness;
  scene.force_limit_n = 1000.0;
  scene.params.coupling.damping_n_s_per_mm = b;
  scene.params.velocity.filter_ms = filter_ms;
  return scene;
}

TEST(Coupling, DampsAlongThePressAndNotAlongTheSurface) {
  Touch touch(tests::flat(), coupled(1.0, 0.002, 0.0));
  static_cast<void>(touch.at({10.0, 10.0, -1.0}));
  // 100 mm/s along, 50 mm/s in: 0.1 N on top of the spring, nothing sideways.
  const ForceSample in = touch.at({10.1, 10.0, -1.05});
  EXPECT_NEAR(in.force_n.z, 1.05 + 0.1, 1e-10);
  EXPECT_NEAR(in.force_n.x, 0.0, 1e-10);
  // Out at 900 mm/s: 1.8 N against a spring of 0.15 N; it does not pull.
  EXPECT_NEAR(touch.at({10.1, 10.0, -0.15}).force_n.z, 0.0, 1e-12);
}

// A mass pressed on a wall of 1.5 times the stiffness that its device's damping bears: buzzes alone, rests
// with enough coupling, and buzzes again beyond 2 m / T.
TEST(Coupling, StopsTheBuzzBetweenItsTwoBounds) {
  const double rate = 1000.0;
  const double m = 0.05;
  const double b_device = 0.001;
  const double k = 1.5 * 2.0 * b_device * rate;  // 3 N/mm: 0.5e-3 N s/mm is missing
  const double bound = 2.0 * m * 1e-3 * rate;    // 0.1 N s/mm
  const auto grows = [&](double b) {
    Touch touch(tests::flat(), coupled(k, b, 0.0), rate);
    HeldMass mass{m, b_device};
    const double press_n = 20.0;
    mass.x_mm = {20.0, 20.0, -press_n / k - 1e-3};
    double early = 0.0, late = 0.0;
    for (int i = 0; i < 1000; ++i) {
      mass.advance(touch.at(mass.x_mm).force_n - glm::dvec3(0.0, 0.0, press_n), touch.period_s);
      double& most = i < 100 ? early : late;
      if (i < 100 || i >= 900) most = std::max(most, std::abs(mass.x_mm.z + press_n / k));
    }
    return late > early;
  };
  EXPECT_TRUE(grows(0.0));
  // Needed: what is missing, and what the coupling's own lag of T takes back, K T^2 / m of b (6 %).
  EXPECT_TRUE(grows(0.0004));
  EXPECT_FALSE(grows(0.0007));
  EXPECT_FALSE(grows(0.02));
  EXPECT_TRUE(grows(1.03 * bound));
}

TEST(Gravity, HoldsUpTheStylusInFreeSpaceAndInTouchButNotWithoutInput) {
  Scene scene = sceneOf({EffectKind::kSpring, EffectKind::kGravity});
  scene.params.gravity.stylus_kg = 0.1;
  Touch touch(tests::flat(), scene);
  const double weight = 0.980665;
  const ForceSample free = touch.at({5.0, 5.0, 3.0});
  EXPECT_FALSE(free.contact);
  EXPECT_NEAR(free.force_n.z, weight, 1e-15);
  EXPECT_NEAR(touch.tick.weight().z, weight, 1e-15);
  EXPECT_NEAR(touch.at({-500.0, 5.0, 3.0}).force_n.z, weight, 1e-15);  // outside the field
  EXPECT_NEAR(touch.at({5.0, 5.0, -0.5}).force_n.z, weight + 0.5, 1e-12);
  EXPECT_EQ(touch.at({5.0, std::nan(""), -0.5}).force_n, glm::dvec3(0.0));
  EXPECT_EQ(touch.tick.weight(), glm::dvec3(0.0));
  // The limit is on the sum.
  EXPECT_NEAR(touch.at({5.0, 5.0, -100.0}).force_n.z, 8.0, 1e-12);
  // It does not press, so it does not count for the brush.
}

TEST(Gravity, AMassThatIsHeldUpStaysWhereItIs) {
  Scene scene = sceneOf({EffectKind::kGravity});
  scene.params.gravity.stylus_kg = 0.08;
  Touch touch(tests::flat(), scene);
  HeldMass mass{0.08};
  mass.x_mm = {5.0, 5.0, 20.0};
  for (int i = 0; i < 5000; ++i)
    mass.advance(touch.at(mass.x_mm).force_n - glm::dvec3(0.0, 0.0, 0.08 * 9.80665), touch.period_s);
  EXPECT_NEAR(mass.x_mm.z, 20.0, 1e-9);
}

}  // namespace
}  // namespace fettle::haptic
