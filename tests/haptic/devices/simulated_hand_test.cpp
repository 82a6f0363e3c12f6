#include "haptic/devices/virtual/simulated_hand.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

namespace fettle::haptic {
namespace {

TEST(SimulatedHand, SettlesWhereHandSpringAndConstantForceBalance) {
  const HandSpec spec{.mass_kg = 0.1, .stiffness_n_per_mm = 0.5, .damping_n_s_per_mm = 0.01};
  SimulatedHand hand({{0.0, {1, 2, 3}}}, spec);
  for (int i = 0; i < 3000; ++i) {
    static_cast<void>(hand.read());
    hand.write({0, 0, 2.0});
  }
  EXPECT_NEAR(hand.positionMm().z, 3.0 + 2.0 / 0.5, 1e-9);
  EXPECT_NEAR(hand.positionMm().x, 1.0, 1e-12);
  // Work of a constant force: force times way.
  EXPECT_NEAR(hand.workOnHandMj(), 2.0 * 4.0, 1e-9);
}

TEST(SimulatedHand, SwingsAtItsNaturalFrequencyWithoutGainOrLoss) {
  // 0.1 kg on 0.5 N/mm: sqrt(500 / 0.1) / 2 pi = 11.25 Hz; let go 1 mm off the target, no damping.
  HandSpec spec{.mass_kg = 0.1, .stiffness_n_per_mm = 0.5, .damping_n_s_per_mm = 0.0};
  SimulatedHand hand({{0.0, {0, 0, 0}}, {1e-9, {1, 0, 0}}}, spec);
  const double w = std::sqrt(500.0 / 0.1);
  double peak = 0.0;
  double worst = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const double x = hand.read().position_mm.x;
    peak = std::max(peak, x);
    if (i > 1 && i < 1000) {
      // Against the closed form; the jump of the target is spread over the first tick, half a tick late.
      const double t = hand.seconds() - 0.5 / spec.rate_hz;
      worst = std::max(worst, std::abs(x - (1.0 - std::cos(w * t))));
    }
  }
  // Symplectic: the amplitude's error is of order w h / 2 = 7e-4 * 0.5 and does not grow; plus (w T)^2 / 24
  // of the spread-out jump.
  EXPECT_NEAR(peak, 2.0, 2e-3);
  EXPECT_LT(worst, 0.01);
}

TEST(SimulatedHand, TrembleIsBoundedAndTheSameForTheSameSeed) {
  HandSpec spec;
  spec.tremor_mm = 0.05;
  SimulatedHand one({{0.0, {0, 0, 0}}}, spec);
  SimulatedHand two({{0.0, {0, 0, 0}}}, spec);
  double sum = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 p = one.read().position_mm;
    EXPECT_EQ(p, two.read().position_mm);
    sum += glm::dot(p, p) / 3.0;
  }
  const double rms = std::sqrt(sum / 20000);
  EXPECT_GT(rms, 0.01);
  EXPECT_LT(rms, 0.2);
}

TEST(SimulatedHand, FollowsItsPathAndNamesTheTool) {
  SimulatedHand hand(
      {{0.0, {0, 0, 0}, Tool::kFeel}, {1.0, {10, 0, 0}, Tool::kMark}, {2.0, {10, 0, 0}, Tool::kFeel}}, {});
  for (int i = 0; i <= 500; ++i) static_cast<void>(hand.read());
  // The spring drags behind a steady target by b v / k less nothing: damping acts on the difference of
  // speeds.
  EXPECT_NEAR(hand.positionMm().x, 5.0, 0.3);
  EXPECT_EQ(hand.read().tool, Tool::kFeel);
  for (int i = 0; i < 600; ++i) static_cast<void>(hand.read());
  EXPECT_EQ(hand.read().tool, Tool::kMark);
  EXPECT_FALSE(hand.finished());
  for (int i = 0; i < 1000; ++i) static_cast<void>(hand.read());
  EXPECT_TRUE(hand.finished());
}

TEST(SimulatedHand, NonFiniteForceIsNone) {
  SimulatedHand hand({{0.0, {0, 0, 0}}}, {});
  for (int i = 0; i < 100; ++i) {
    static_cast<void>(hand.read());
    hand.write({std::nan(""), std::numeric_limits<double>::infinity(), 0});
  }
  EXPECT_EQ(hand.positionMm(), glm::dvec3{0.0});
}

TEST(SimulatedHand, PositionIsReadInStepsOfItsResolution) {
  HandSpec spec;
  spec.resolution_mm = 0.05;
  SimulatedHand hand({{0.0, {0, 0, 0}}, {1.0, {1, 0, 0}}}, spec);
  for (int i = 0; i < 500; ++i) {
    const double steps = hand.read().position_mm.x / 0.05;
    EXPECT_NEAR(steps, std::round(steps), 1e-9);
  }
}

// The largest wall stiffness that does not buzz, by bisection: a hand without stiffness or damping of its own
// on a sampled wall of stiffness K, with the device's damping b.
double boundary(double rate_hz, double b_n_s_per_mm) {
  double low = 0.0;
  double high = 20.0;
  for (int i = 0; i < 14; ++i) {
    const double k = 0.5 * (low + high);
    HandSpec spec{.mass_kg = 0.2, .stiffness_n_per_mm = 0.0, .damping_n_s_per_mm = 0.0};
    spec.device_damping_n_s_per_mm = b_n_s_per_mm;
    spec.rate_hz = rate_hz;
    SimulatedHand hand({{0.0, {0, 0, 0}}}, spec);
    // Two-sided spring, kicked once: grows or dies.
    double early = 0.0;
    double late = 0.0;
    const int ticks = static_cast<int>(2.0 * rate_hz);
    for (int t = 0; t < ticks; ++t) {
      const glm::dvec3 p = hand.read().position_mm;
      hand.write(t == 0 ? glm::dvec3{0, 0, 1.0} : -k * p);
      double& side = t < ticks / 2 ? early : late;
      side = std::max(side, glm::length(p));
      if (side > 1e6) break;
    }
    (late > early ? high : low) = k;
  }
  return 0.5 * (low + high);
}

TEST(SimulatedHand, SampledWallStartsToBuzzWhereTheorySays) {
  // Colgate and Schenkel, Passivity of a class of sampled-data systems (1997): b > K T / 2. For a free mass
  // on a sampled spring it is also the stability limit to first order in T, without the loop's computing
  // delay.
  for (const double rate : {1000.0, 2000.0, 5000.0}) {
    const double b = 0.001;  // N s/mm
    const double theory = 2.0 * b * rate;
    EXPECT_NEAR(boundary(rate, b) / theory, 1.0, 0.15) << rate;
  }
}

}  // namespace
}  // namespace fettle::haptic
