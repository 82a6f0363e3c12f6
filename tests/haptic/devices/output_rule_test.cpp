#include "haptic/devices/hid/output_rule.h"

#include <algorithm>
#include <cstdint>
#include <random>
#include <utility>

#include <gtest/gtest.h>

namespace fettle::haptic {
namespace {

using Send = OutputRule::Send;
constexpr std::int64_t kUs = 1000;
constexpr std::int64_t kMs = 1000 * kUs;

TEST(OutputRule, FreeDeviceGetsEachFreshForceOnceAtOnce) {
  OutputRule rule(Pacing::kFree, {});
  rule.open(0, 0);
  EXPECT_EQ(rule.decide(1 * kMs, 5), Send::kNothing);
  rule.force(2 * kMs);
  EXPECT_EQ(rule.decide(2 * kMs, 5), Send::kForce);
  EXPECT_EQ(rule.decide(2 * kMs, 6), Send::kNothing);
}

TEST(OutputRule, ForceThatIsNotRenewedIsTakenBackAfterTenMilliseconds) {
  OutputRule rule(Pacing::kFree, {});
  rule.open(0, 0);
  rule.force(1 * kMs);
  EXPECT_EQ(rule.decide(1 * kMs, 0), Send::kForce);
  EXPECT_EQ(rule.deadline(1 * kMs), 11 * kMs);
  EXPECT_EQ(rule.decide(11 * kMs - 1, 0), Send::kNothing);
  EXPECT_EQ(rule.decide(11 * kMs, 0), Send::kZero);
  EXPECT_EQ(rule.decide(12 * kMs, 0), Send::kNothing);
}

TEST(OutputRule, ForceFoundAfterAStallIsTooOldToBeGiven) {
  OutputRule rule(Pacing::kFree, {});
  rule.open(0, 0);
  rule.force(1 * kMs);
  EXPECT_EQ(rule.decide(1 * kMs, 0), Send::kForce);
  rule.force(3 * kMs);  // written while the writer hung in a write for 5 s, and the loop died
  EXPECT_EQ(rule.decide(5000 * kMs, 0), Send::kZero);
}

TEST(OutputRule, LockStepInputIsAnsweredByTheNextFreshForce) {
  OutputRule rule(Pacing::kLockStep, {});
  rule.open(0, 0);
  rule.force(0);
  EXPECT_EQ(rule.decide(0, 0), Send::kNothing);  // no input, no reply
  EXPECT_EQ(rule.decide(1 * kMs, 1), Send::kForce);
  EXPECT_EQ(rule.decide(2 * kMs, 2), Send::kNothing);  // waits for the loop ...
  rule.force(2 * kMs + 300 * kUs);
  EXPECT_EQ(rule.decide(2 * kMs + 300 * kUs, 2), Send::kForce);
}

TEST(OutputRule, LockStepInputIsAnsweredByTheLastForceWhenTheLoopIsLateAndByZeroWhenItIsGone) {
  OutputRule rule(Pacing::kLockStep, {});
  rule.open(0, 0);
  rule.force(0);
  EXPECT_EQ(rule.decide(0, 1), Send::kForce);
  EXPECT_EQ(rule.decide(3 * kMs, 2), Send::kNothing);
  EXPECT_EQ(rule.deadline(3 * kMs), 5 * kMs);
  EXPECT_EQ(rule.decide(5 * kMs, 2), Send::kForce);
  EXPECT_EQ(rule.decide(9 * kMs, 3), Send::kNothing);
  EXPECT_EQ(rule.decide(11 * kMs, 3), Send::kZero);
}

TEST(OutputRule, SilentLockStepDeviceIsKickedByZeros) {
  OutputRule rule(Pacing::kLockStep, {});
  rule.open(0, 0);
  int zeros = 0;
  for (std::int64_t t = 0; t <= 100 * kMs; t += 100 * kUs) {
    rule.force(t);  // forces are no replies to inputs that never came
    const Send what = rule.decide(t, 0);
    EXPECT_NE(what, Send::kForce);
    zeros += what == Send::kZero ? 1 : 0;
  }
  EXPECT_EQ(zeros, 10);
}

TEST(OutputRule, RepliesCatchUpOneByOneWhenInputsCameInABunch) {
  OutputRule rule(Pacing::kLockStep, {});
  rule.open(0, 10);
  int replies = 0;
  for (std::int64_t t = 0; t < 20 * kMs; t += 100 * kUs) {
    rule.force(t);
    replies += rule.decide(t, 13) == Send::kForce ? 1 : 0;
  }
  EXPECT_EQ(replies, 3);
}

TEST(OutputRule, FreeDeviceThatStreamsGetsZerosInsideItsWatchdogFromASilentLoop) {
  OutputRule rule(Pacing::kFree, {});
  rule.open(0, 0);
  int zeros = 0;
  for (std::int64_t t = 0; t < 1000 * kMs; t += kMs)
    zeros += rule.decide(t, static_cast<std::uint64_t>(t / kMs)) == Send::kZero ? 1 : 0;
  EXPECT_EQ(zeros, 9);  // every 100 ms
}

TEST(OutputRule, NothingIsEverSentToADeviceWithoutOutput) {
  OutputRule rule(Pacing::kNone, {});
  rule.open(0, 0);
  for (std::int64_t t = 0; t < 2000 * kMs; t += kMs) {
    rule.force(t);
    EXPECT_EQ(rule.decide(t, static_cast<std::uint64_t>(t)), Send::kNothing);
  }
}

// A device with a watchdog on the rule, in steps of 50 us of virtual time.
struct SimulatedDevice {
  bool lock_step = false;
  std::int64_t watchdog = 0;
  std::int64_t next_input = 0;
  bool waits_for_reply = false;
  std::int64_t last_output = 0;
  std::uint64_t inputs = 0;
  std::uint64_t outputs = 0;
  std::uint64_t watchdog_fired = 0;
  bool nonzero = false;

  void step(std::int64_t now) {
    if (now - last_output >= watchdog) {
      ++watchdog_fired;
      last_output = now;
      nonzero = false;
    }
    if (now >= next_input && !(lock_step && waits_for_reply)) {
      ++inputs;
      waits_for_reply = true;
      next_input = now + 1 * kMs;
    }
  }
  void take(std::int64_t now, bool force) {
    ++outputs;
    last_output = now;
    waits_for_reply = false;
    nonzero = force;
  }
};

struct Simulation {
  SimulatedDevice device;
  std::int64_t worst_stale_force = 0;  // longest time a force stayed on after the loop's last write
};

// The loop works, hangs for `gap` every 200 ms, works again; one output in `lose_one_in` gets lost.
Simulation simulate(Pacing pacing, std::int64_t watchdog, std::int64_t gap, unsigned lose_one_in) {
  Simulation run;
  run.device.lock_step = pacing == Pacing::kLockStep;
  run.device.watchdog = watchdog;
  OutputRule rule(pacing, {});
  rule.open(0, 0);
  std::mt19937 random(3);
  std::int64_t next_tick = 0;
  std::int64_t last_write = 0;
  for (std::int64_t t = 0; t < 10'000 * kMs; t += 50 * kUs) {
    run.device.step(t);
    if (t >= next_tick) {
      next_tick += 1 * kMs;
      if (t % (200 * kMs) >= gap) {
        rule.force(t);
        last_write = t;
      }
    }
    const Send what = rule.decide(t, run.device.inputs);
    if (what != Send::kNothing && (lose_one_in == 0 || random() % lose_one_in != 0))
      run.device.take(t, what == Send::kForce);
    if (run.device.nonzero) run.worst_stale_force = std::max(run.worst_stale_force, t - last_write);
  }
  return run;
}

TEST(OutputRule, NoWatchdogFiresInTenSecondsWithALoopThatHangsAndAnOutputThatGetsLost) {
  // P14 and S lock-step, W8 free; the watchdogs of their firmware.
  for (const auto& [pacing, watchdog] :
       {std::pair{Pacing::kLockStep, 500 * kMs}, std::pair{Pacing::kLockStep, 100 * kMs},
        std::pair{Pacing::kFree, 500 * kMs}}) {
    for (const std::int64_t gap : {0 * kMs, 30 * kMs, 199 * kMs}) {
      for (const unsigned lose : {0U, 50U}) {
        const Simulation run = simulate(pacing, watchdog, gap, lose);
        EXPECT_EQ(run.device.watchdog_fired, 0U) << gap << " " << lose;
        // Taken back after 10 ms without renewal; a reply may wait 2 ms more, a lost one 10 ms.
        const std::int64_t worst = (lose == 0 ? 13 : 40) * kMs;
        if (pacing == Pacing::kLockStep || lose == 0) {
          EXPECT_LE(run.worst_stale_force, worst) << gap;
        }
      }
    }
  }
}

TEST(OutputRule, LockStepAnswersEachInputExactlyOnce) {
  const Simulation run = simulate(Pacing::kLockStep, 500 * kMs, 0, 0);
  // A device tick, then an answer within the loop's next tick: the device runs on at its own 1 kHz.
  EXPECT_GT(run.device.inputs, 9'900U);
  EXPECT_LE(run.device.inputs - run.device.outputs, 1U);
}

}  // namespace
}  // namespace fettle::haptic
