#include "haptic/safety/safety.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/haptic/safety/guard_witness.h"

namespace fettle::haptic {
namespace {

using tests::GuardWitness;

constexpr double kDt = 0.001;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

SafetyInput pressing(double newtons) {
  SafetyInput in;
  in.dt_s = kDt;
  in.link = LinkState::kConnected;
  in.command_n = {0.0, 0.0, newtons};
  return in;
}

SafetyLimits woody() {
  SafetyLimits limits;
  limits.peak_force_n = 5.0;
  limits.continuous_force_n = 2.0;
  limits.slew_n_per_ms = 1.0;
  return limits;
}

void run(GuardWitness& w, const SafetyInput& in, int ticks) {
  for (int i = 0; i < ticks; ++i) static_cast<void>(w.step(in));
}

// Armed, touched nothing, ramp over.
GuardWitness active(const SafetyLimits& limits = woody()) {
  GuardWitness w(limits);
  run(w, pressing(0.0), 3);
  w.arm();
  run(w, pressing(0.0), 1100);
  EXPECT_EQ(w.guard().state(), SafetyState::kActive);
  w.forgetPeaks();
  return w;
}

TEST(ForceGuard, NothingIsGivenBeforeItIsArmed) {
  GuardWitness w(woody());
  EXPECT_EQ(w.guard().state(), SafetyState::kDisconnected);
  run(w, pressing(3.0), 100);
  EXPECT_EQ(w.guard().state(), SafetyState::kUncalibrated);
  EXPECT_EQ(w.peakForce(), 0.0);
  EXPECT_FALSE(w.problem()) << *w.problem();
}

TEST(ForceGuard, UncalibratedDeviceCanNotBeArmed) {
  GuardWitness w(woody());
  SafetyInput in = pressing(0.0);
  in.link = LinkState::kUncalibrated;
  run(w, in, 3);
  w.arm();
  run(w, in, 3);
  EXPECT_EQ(w.guard().state(), SafetyState::kUncalibrated);
  EXPECT_EQ(w.guard().counters().arms_refused, 1);
}

TEST(ForceGuard, WhoArmsDeepInsideMustFirstComeOut) {
  GuardWitness w(woody());
  run(w, pressing(4.0), 3);
  w.arm();
  run(w, pressing(4.0), 2000);
  EXPECT_EQ(w.guard().state(), SafetyState::kArmed);
  EXPECT_EQ(w.peakForce(), 0.0);
  run(w, pressing(0.05), 1);  // small
  EXPECT_EQ(w.guard().state(), SafetyState::kRamping);
  // Half of the ramp later, half of the peak is the most there is.
  run(w, pressing(4.0), 249);
  EXPECT_NEAR(w.peakForce(), 2.5, 0.02);
  run(w, pressing(4.0), 400);
  EXPECT_EQ(w.guard().state(), SafetyState::kActive);
  EXPECT_NEAR(w.peakForce(), 4.0, 1e-12);
  EXPECT_FALSE(w.problem()) << *w.problem();
}

TEST(ForceGuard, ForceAbovethePeakIsCutAlongItsDirection) {
  GuardWitness w = active();
  SafetyInput in = pressing(0.0);
  in.command_n = {30.0, 0.0, 40.0};
  glm::dvec3 f(0.0);
  for (int i = 0; i < 20; ++i) f = w.step(in);
  EXPECT_NEAR(f.x, 3.0, 1e-9);
  EXPECT_NEAR(f.z, 4.0, 1e-9);
  EXPECT_GT(w.guard().counters().clamped, 0);
  EXPECT_FALSE(w.problem()) << *w.problem();
}

TEST(ForceGuard, HugeAndDenormalCommandsKeepDirectionOrVanish) {
  GuardWitness w = active();
  SafetyInput in = pressing(0.0);
  in.command_n = {1e308, -1e308, 1e308};
  glm::dvec3 f(0.0);
  for (int i = 0; i < 20; ++i) f = w.step(in);
  EXPECT_NEAR(f.x, 5.0 / std::sqrt(3.0), 1e-9);
  EXPECT_NEAR(f.y, -5.0 / std::sqrt(3.0), 1e-9);
  in.command_n = {5e-324, 0.0, 0.0};
  for (int i = 0; i < 20; ++i) f = w.step(in);
  EXPECT_LE(f.x, 5e-324);
  EXPECT_FALSE(w.problem()) << *w.problem();
}

TEST(ForceGuard, NaNForSomeTicksFadesAndComesBackForFiftyMillisecondsFaults) {
  GuardWitness w = active();
  run(w, pressing(3.0), 20);
  SafetyInput bad = pressing(kNaN);
  run(w, bad, 3);
  EXPECT_NEAR(w.guard().force().z, 0.0, 1e-12);  // slew 1 N/ms
  run(w, pressing(3.0), 10);
  EXPECT_NEAR(w.guard().force().z, 3.0, 1e-12);
  EXPECT_EQ(w.guard().counters().not_finite, 3);
  run(w, bad, 51);
  EXPECT_EQ(w.guard().state(), SafetyState::kFault);
  EXPECT_EQ(w.guard().cause(), FaultCause::kInputLost);
  EXPECT_FALSE(w.problem()) << *w.problem();
}

TEST(ForceGuard, GapOfTenMillisecondsIsZeroForceAndARampAfterIt) {
  GuardWitness w = active();
  run(w, pressing(4.0), 20);
  SafetyInput silent = pressing(4.0);
  for (int ms = 1; ms <= 20; ++ms) {
    silent.input_age_s = 0.001 * ms;
    const glm::dvec3 f = w.step(silent);
    if (ms < 10) {
      EXPECT_NEAR(f.z, 4.0, 1e-12);
    }
    // 4 N at 1 N/ms
    if (ms >= 14) {
      EXPECT_EQ(f.z, 0.0);
    }
  }
  EXPECT_EQ(w.guard().counters().silences, 1);
  w.forgetPeaks();
  run(w, pressing(4.0), 100);
  EXPECT_EQ(w.guard().state(), SafetyState::kRamping);
  EXPECT_NEAR(w.peakForce(), 1.0, 1e-9);  // 100 ms of 500 ms to 5 N
  EXPECT_FALSE(w.problem()) << *w.problem();
}

TEST(ForceGuard, GapOfFiftyMillisecondsIsAFaultUntilReArmed) {
  GuardWitness w = active();
  run(w, pressing(4.0), 20);
  SafetyInput silent = pressing(4.0);
  for (int ms = 1; ms <= 60; ++ms) {
    silent.input_age_s = 0.001 * ms;
    static_cast<void>(w.step(silent));
  }
  EXPECT_EQ(w.guard().state(), SafetyState::kFault);
  run(w, pressing(0.0), 5000);
  EXPECT_EQ(w.guard().state(), SafetyState::kFault);
  w.guard().disarm();
  run(w, pressing(0.0), 10);
  EXPECT_EQ(w.guard().state(), SafetyState::kFault);
  w.arm();
  run(w, pressing(0.0), 1);
  EXPECT_NE(w.guard().state(), SafetyState::kFault);
  EXPECT_EQ(w.guard().cause(), FaultCause::kNone);
  EXPECT_FALSE(w.problem()) << *w.problem();
}

TEST(ForceGuard, DebuggerStopIsAFaultAtTheFirstTickAfterIt) {
  GuardWitness w = active();
  run(w, pressing(4.0), 20);
  SafetyInput late = pressing(4.0);
  late.dt_s = 7.0;
  EXPECT_EQ(w.step(late), glm::dvec3(0.0));
  EXPECT_EQ(w.guard().state(), SafetyState::kFault);
  EXPECT_EQ(w.guard().cause(), FaultCause::kLoopStopped);
}

TEST(ForceGuard, DeviceThatTakesNoReportForFiftyMillisecondsIsAFaultAndCanNotBeArmed) {
  GuardWitness w = active();
  run(w, pressing(4.0), 20);
  SafetyInput waits = pressing(4.0);
  waits.output_waits_s = 0.049;
  run(w, waits, 5);
  EXPECT_EQ(w.guard().state(), SafetyState::kActive);
  waits.output_waits_s = 0.050;
  run(w, waits, 1);
  EXPECT_EQ(w.guard().cause(), FaultCause::kOutputStalled);
  const std::int64_t refused = w.guard().counters().arms_refused;
  w.arm();
  run(w, waits, 10);
  EXPECT_EQ(w.guard().state(), SafetyState::kFault);
  EXPECT_EQ(w.guard().counters().arms_refused, refused + 1);
  EXPECT_EQ(glm::length(w.guard().force()), 0.0);
  w.arm();
  run(w, pressing(0.0), 2);
  EXPECT_EQ(w.guard().state(), SafetyState::kRamping);
  EXPECT_FALSE(w.problem()) << *w.problem();
}

TEST(ForceGuard, ADeviceThatMissesReportsIsGivenNoMoreThanTwoMillisecondsOfRiseAtOnce) {
  GuardWitness w = active();
  SafetyInput missed = pressing(4.0);
  EXPECT_DOUBLE_EQ(w.step(missed).z, 1.0);  // sent
  missed.output_pending = true;
  SafetyInput sent = missed;
  sent.output_pending = false;
  EXPECT_DOUBLE_EQ(w.step(sent).z, 2.0);
  for (int i = 0; i < 20; ++i) EXPECT_LE(w.step(missed).z, 3.0) << i;  // the device still holds 1 N
  EXPECT_DOUBLE_EQ(w.guard().force().z, 3.0);
  EXPECT_EQ(w.guard().counters().behind, 19);
  EXPECT_DOUBLE_EQ(w.step(sent).z, 4.0);
  EXPECT_FALSE(w.problem()) << *w.problem();
}

TEST(ForceGuard, AForceThatTurnsRoundWhileReportsAreMissedPassesZeroByTwoMillisecondsOfRise) {
  GuardWitness w = active();
  run(w, pressing(4.0), 20);
  SafetyInput missed = pressing(-4.0);
  missed.output_pending = true;
  run(w, missed, 4);
  EXPECT_DOUBLE_EQ(w.guard().force().z, 0.0);  // a force that falls is not held up
  run(w, missed, 20);
  EXPECT_DOUBLE_EQ(w.guard().force().z, -2.0);
  run(w, pressing(-4.0), 2);
  EXPECT_DOUBLE_EQ(w.guard().force().z, -4.0);
  EXPECT_FALSE(w.problem()) << *w.problem();
}

TEST(ForceGuard, UnplugIsZeroAtOnceAndNeedsReArmingAfterRePlug) {
  GuardWitness w = active();
  run(w, pressing(4.0), 20);
  SafetyInput gone = pressing(4.0);
  gone.link = LinkState::kDisconnected;
  EXPECT_EQ(w.step(gone), glm::dvec3(0.0));
  EXPECT_EQ(w.guard().cause(), FaultCause::kUnplugged);
  run(w, pressing(0.0), 100);
  EXPECT_EQ(w.guard().state(), SafetyState::kFault);
  w.arm();
  run(w, pressing(0.0), 2);
  EXPECT_EQ(w.guard().state(), SafetyState::kRamping);
  EXPECT_FALSE(w.problem()) << *w.problem();
}

TEST(ForceGuard, SurfaceThatRisesUnderARestingTipRampsAndAStrokeOfTheHandDoesNot) {
  GuardWitness w = active();
  run(w, pressing(1.0), 50);
  w.forgetPeaks();
  SafetyInput lifted = pressing(11.0);
  lifted.disturbance = Disturbance::kSurfaceReplaced;
  static_cast<void>(w.step(lifted));
  EXPECT_LE(w.guard().force().z, 1.0 + 0.1 + 0.01 + 1e-9);  // as before + small + one tick of ramp
  run(w, pressing(11.0), 99);
  EXPECT_NEAR(w.guard().force().z, 1.1 + 1.0, 0.02);
  EXPECT_LE(w.peakRise(), 0.1 + 0.01 + 1e-9);
  EXPECT_EQ(w.guard().counters().disturbances_ramped, 1);

  // The same rise by a hand is passed on, at the slew limit.
  GuardWitness hand = active();
  run(hand, pressing(1.0), 50);
  run(hand, pressing(11.0), 10);
  EXPECT_NEAR(hand.guard().force().z, 5.0, 1e-9);
}

TEST(ForceGuard, DisturbanceThatLowersTheForceRampsNothing) {
  GuardWitness w = active();
  run(w, pressing(3.0), 50);
  SafetyInput lower = pressing(1.0);
  lower.disturbance = Disturbance::kSurfaceReplaced;
  run(w, lower, 5);
  EXPECT_EQ(w.guard().state(), SafetyState::kActive);
  EXPECT_NEAR(w.guard().force().z, 1.0, 1e-12);
}

TEST(ForceGuard, PoseThatJumpsRamps) {
  GuardWitness w = active();
  SafetyInput jump = pressing(5.0);
  jump.velocity_mm_per_s = {0.0, 0.0, -20000.0};  // 20 mm in one tick
  static_cast<void>(w.step(jump));
  run(w, pressing(5.0), 49);
  EXPECT_LT(w.peakForce(), 0.1 + 0.5 + 1e-9);  // 50 ms of 10 N/s
  EXPECT_EQ(w.guard().counters().jumps, 1);
}

TEST(ForceGuard, TipAboveTheSpeedLimitIsBrakedAndNotDriven) {
  GuardWitness w = active();
  SafetyInput fast = pressing(2.0);
  fast.velocity_mm_per_s = {0.0, 0.0, 3000.0};  // twice the limit, along the force
  run(w, fast, 200);
  // All of the drive gone, 0.004 N s/mm of the excess against the motion.
  EXPECT_NEAR(w.guard().force().z, -5.0, 1.1);
  EXPECT_LT(w.guard().force().z, 0.0);
  EXPECT_FALSE(w.problem()) << *w.problem();
}

// The brake adds to a force across the motion: its length is held again behind it, by the limit of warmth, which never is
// above the peak, and by the last clamp behind that.
TEST(ForceGuard, BrakeAcrossTheFullForceStaysWithinThePeak) {
  GuardWitness w = active();
  SafetyInput fast = pressing(5.0);
  fast.velocity_mm_per_s = {3000.0, 0.0, 0.0};
  run(w, fast, 50);
  EXPECT_LT(w.guard().force().x, -3.0);  // braked
  EXPECT_GT(w.guard().force().z, 3.0);   // and pressed
  EXPECT_LE(w.peakForce(), 5.0 + 1e-12);
  EXPECT_GT(w.guard().counters().thermal, 0);
  EXPECT_FALSE(w.problem()) << *w.problem();
}

TEST(ForceGuard, FaultWhileBrakingFadesFromWhatTheHandHas) {
  GuardWitness w = active();
  SafetyInput fast = pressing(4.0);
  fast.velocity_mm_per_s = {0.0, 0.0, 2000.0};  // a third of the drive is gone, 2 N of brake: less than asked
  run(w, fast, 50);
  const double braked = glm::length(w.guard().force());
  ASSERT_LT(braked, 1.0);
  w.guard().lastResort();
  w.forgetPeaks();
  run(w, pressing(4.0), 20);
  EXPECT_LE(w.peakForce(), braked);
  EXPECT_FALSE(w.problem()) << *w.problem();
}

TEST(ForceGuard, MotorsScaleKeepsDirectionAndNonsenseFromItIsZero) {
  static double factor;
  SafetyLimits limits = woody();
  limits.motors.factor = [](const void*, const glm::dvec3&) noexcept { return factor; };
  factor = 0.5;
  GuardWitness w = active(limits);
  SafetyInput in = pressing(0.0);
  in.command_n = {1.2, 0.0, 1.6};
  run(w, in, 20);
  EXPECT_NEAR(w.guard().force().x, 0.6, 1e-9);
  EXPECT_NEAR(w.guard().force().z, 0.8, 1e-9);
  for (const double nonsense : {kNaN, -1.0, 2.0}) {
    factor = nonsense;
    run(w, in, 20);
    EXPECT_EQ(glm::length(w.guard().force()), 0.0);
  }
  EXPECT_EQ(w.guard().counters().bad_motor_scale, 60);
  EXPECT_FALSE(w.problem()) << *w.problem();
}

TEST(ForceGuard, OnlyTicksInWhichTheMotorsHoldTheForceBackAreCounted) {
  static double factor;
  SafetyLimits limits = woody();
  limits.motors.factor = [](const void*, const glm::dvec3&) noexcept { return factor; };
  factor = 1.0;
  GuardWitness w = active(limits);
  run(w, pressing(2.0), 50);
  EXPECT_EQ(w.guard().counters().motor_scaled, 0);
  factor = 0.5;
  run(w, pressing(2.0), 7);
  EXPECT_EQ(w.guard().counters().motor_scaled, 7);
}

TEST(ForceGuard, MotorsAreNeverWarmerThanTheyMayBe) {
  SafetyLimits limits = woody();
  limits.thermal_tau_s = 2.0;
  GuardWitness w = active(limits);
  double warmest = 0.0;
  for (int i = 0; i < 30000; ++i) {
    static_cast<void>(w.step(pressing(5.0)));
    warmest = std::max(warmest, w.guard().warmth());
  }
  EXPECT_LE(warmest, 1.0 + 1e-9);
  EXPECT_GT(warmest, 0.9);
  EXPECT_NEAR(w.guard().force().z, limits.continuous_force_n, 0.15);
  EXPECT_GT(w.guard().counters().thermal, 0);
  EXPECT_FALSE(w.problem()) << *w.problem();
  run(w, pressing(0.0), 10000);  // five time constants: e^-5
  EXPECT_LT(w.guard().warmth(), 0.01);
}

TEST(ForceGuard, LastResortIsAFaultThatCanNotBeArmedAway) {
  GuardWitness w = active();
  run(w, pressing(2.0), 20);
  w.guard().lastResort();
  run(w, pressing(2.0), 10);
  EXPECT_EQ(w.guard().cause(), FaultCause::kLastResort);
  EXPECT_EQ(glm::length(w.guard().force()), 0.0);
  w.arm();
  run(w, pressing(0.0), 2);
  EXPECT_EQ(w.guard().state(), SafetyState::kFault);
}

TEST(SafetyLimits, OfADeviceWithoutForceGiveNone) {
  DeviceProfile mouse;
  mouse.max_force_n = 0.0;
  const SafetyLimits limits = limitsFor(mouse);
  EXPECT_FALSE(limitsProblem(limits));
  GuardWitness w(limits);
  run(w, pressing(0.0), 3);
  w.arm();
  run(w, pressing(0.0), 3);
  run(w, pressing(5.0), 1000);
  EXPECT_EQ(w.peakForce(), 0.0);
  EXPECT_FALSE(w.problem()) << *w.problem();
}

TEST(SafetyLimits, FollowWhatTheDeviceStatesOfItself) {
  DeviceProfile profile;
  profile.max_force_n = 8.0;
  profile.max_damping_n_s_per_mm = 0.003;
  SafetyLimits limits = limitsFor(profile);
  EXPECT_FALSE(limitsProblem(limits));
  EXPECT_EQ(limits.peak_force_n, 8.0);
  EXPECT_DOUBLE_EQ(limits.continuous_force_n, 3.2);  // 0.4 of it
  EXPECT_DOUBLE_EQ(limits.slew_n_per_ms, 1.6);       // all of it in 5 ms
  EXPECT_DOUBLE_EQ(limits.small_force_n, 0.1);
  EXPECT_EQ(limits.damping_n_s_per_mm, 0.003);
  profile.max_force_n = 1.0;
  limits = limitsFor(profile);
  EXPECT_DOUBLE_EQ(limits.slew_n_per_ms, 0.2);
  EXPECT_DOUBLE_EQ(limits.small_force_n, 0.05);  // a twentieth, of a weak device
  // The largest values that are believed, and the next.
  profile.max_force_n = 1000.0;
  profile.max_damping_n_s_per_mm = 1.0;
  EXPECT_EQ(limitsFor(profile).peak_force_n, 1000.0);
  EXPECT_EQ(limitsFor(profile).damping_n_s_per_mm, 1.0);
  profile.max_force_n = 1001.0;
  profile.max_damping_n_s_per_mm = 1.01;
  EXPECT_EQ(limitsFor(profile).peak_force_n, 0.0);
  EXPECT_EQ(limitsFor(profile).damping_n_s_per_mm, 0.0);
}

TEST(SafetyLimits, AreRefusedBeyondTheStatedRanges) {
  struct Range {
    double SafetyLimits::*limit;
    double least, most, beyond;
  };
  for (const Range& range : {Range{&SafetyLimits::peak_force_n, 2.0, 1000.0, 1001.0},
                             {&SafetyLimits::continuous_force_n, 0.0, 5.0, 5.01},
                             {&SafetyLimits::thermal_tau_s, 0.1, 1e6, 1.01e6},
                             {&SafetyLimits::slew_n_per_ms, 1e-6, 1e6, 1.01e6},
                             {&SafetyLimits::ramp_s, 0.5, 1.0, 1.01},
                             {&SafetyLimits::damping_n_s_per_mm, 0.0, 1.0, 1.01},
                             {&SafetyLimits::small_force_n, 0.0, 1.0, 1.01},
                             {&SafetyLimits::fault_s, 0.01, 10.0, 10.1}}) {
    SafetyLimits limits = woody();
    for (const double good : {range.least, range.most}) {
      limits.*range.limit = good;
      EXPECT_FALSE(limitsProblem(limits)) << *limitsProblem(limits);
    }
    for (const double bad : {range.least - 0.001, range.beyond, kNaN}) {
      limits.*range.limit = bad;
      EXPECT_TRUE(limitsProblem(limits)) << bad;
    }
  }
}

TEST(SafetyLimits, OfAProfileFullOfNonsenseGiveNone) {
  DeviceProfile profile;
  for (const double nonsense : {kNaN, -3.0, 1e9, std::numeric_limits<double>::infinity()}) {
    profile.max_force_n = nonsense;
    profile.max_damping_n_s_per_mm = nonsense;
    const SafetyLimits limits = limitsFor(profile);
    EXPECT_FALSE(limitsProblem(limits));
    EXPECT_EQ(limits.peak_force_n, 0.0);
  }
  SafetyLimits bad;
  bad.ramp_s = 0.01;
  EXPECT_TRUE(limitsProblem(bad));
}

}  // namespace
}  // namespace fettle::haptic
