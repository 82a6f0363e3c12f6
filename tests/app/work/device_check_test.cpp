#include "app/work/device_check.h"

#include <gtest/gtest.h>

namespace fettle::app {
namespace {

// A device under a hand, a tick each millisecond.
class HandledDevice {
 public:
  HandledDevice() {
    state.link = haptic::LinkState::kConnected;
    state.tick = 1;
  }
  void tickAt(DeviceCheck& check, const glm::dvec3& position_mm) {
    state.device_mm = position_mm;
    ++state.tick;
    state.time_ns += 1'000'000;
    check.note(state);
  }
  haptic::LoopState state;
};

TEST(DeviceCheck, ReachIsTheBoxOfAllPositionsFromItsBeginOn) {
  DeviceCheck check;
  HandledDevice device;
  device.tickAt(check, {500.0, 0.0, 0.0});
  EXPECT_FALSE(check.reach());
  check.beginReach();
  for (const glm::dvec3& p : {glm::dvec3(-30.0, 0.0, 1.0), glm::dvec3(50.0, -20.0, 2.0)})
    device.tickAt(check, p);
  EXPECT_FALSE(check.reachIsUsable());  // a millimetre up and down
  device.tickAt(check, {0.0, 40.0, 61.0});
  EXPECT_TRUE(check.reachIsUsable());
  check.stop();
  device.tickAt(check, {500.0, 500.0, 500.0});
  EXPECT_EQ(check.reach()->low_mm, glm::dvec3(-30.0, -20.0, 1.0));
  EXPECT_EQ(check.reach()->high_mm, glm::dvec3(50.0, 40.0, 61.0));
  EXPECT_EQ(check.reach()->middle(), glm::dvec3(10.0, 10.0, 31.0));
  EXPECT_DOUBLE_EQ(check.reach()->radius(), 30.0);
  check.beginReach();
  EXPECT_FALSE(check.reach());
}

TEST(DeviceCheck, APositionWithoutADeviceCountsForNothing) {
  DeviceCheck check;
  HandledDevice device;
  check.beginReach();
  for (const auto link : {haptic::LinkState::kDisconnected, haptic::LinkState::kUncalibrated}) {
    device.state.link = link;
    device.tickAt(check, {1.0, 2.0, 3.0});
    EXPECT_FALSE(check.reach());
  }
}

TEST(DeviceCheck, RestIsTheLargestForceAndTheFarthestMovementOfTwoSeconds) {
  DeviceCheck check;
  HandledDevice device;
  device.state.safety_counters.faults = 7;  // of before
  check.beginRest();
  for (int ms = 0; ms < 1999; ++ms) {
    device.state.given_n = ms == 700 ? glm::dvec3(0.0, 0.3, -0.4) : glm::dvec3(0.0);
    if (ms == 900) ++device.state.safety_counters.faults;
    device.tickAt(check, {ms == 400 ? 0.25 : 0.0, 0.0, ms == 500 ? -0.5 : 0.5});
  }
  EXPECT_FALSE(check.rest());
  EXPECT_NEAR(check.restDone(), 1.0, 0.01);
  for (int ms = 0; ms < 5; ++ms) device.tickAt(check, {90.0, 0.0, 0.0});
  ASSERT_TRUE(check.rest());
  EXPECT_EQ(check.running(), DeviceCheck::Running::kNothing);
  EXPECT_DOUBLE_EQ(check.rest()->force_n, 0.5);
  EXPECT_EQ(check.rest()->device_faults, 1U);
  EXPECT_GE(check.rest()->moved_mm, 1.0);
}

TEST(DeviceCheck, TheAxisThatAnswersToAPushIsNamedWithItsSign) {
  struct Push {
    PushedWay way;
    glm::dvec3 moved_mm;
    const char* came;
    bool expected;
  };
  for (const Push& push : {Push{PushedWay::kRight, {40.0, 3.0, -5.0}, "+x", true},
                           Push{PushedWay::kRight, {1.0, -40.0, 0.0}, "-y", false},
                           Push{PushedWay::kAway, {0.0, -40.0, 0.0}, "-y", false},
                           Push{PushedWay::kAway, {2.0, 40.0, 0.0}, "+y", true},
                           Push{PushedWay::kUp, {0.0, 0.0, 40.0}, "+z", true},
                           Push{PushedWay::kUp, {-40.0, 0.0, 4.0}, "-x", false}}) {
    DeviceCheck check;
    HandledDevice device;
    check.beginDirection(push.way);
    const glm::dvec3 from(7.0, -8.0, 9.0);
    for (int i = 0; i <= 100; ++i) device.tickAt(check, from + 0.01 * i * push.moved_mm);
    ASSERT_TRUE(check.direction(push.way)) << push.came;
    EXPECT_EQ(axisText(*check.direction(push.way)), push.came);
    EXPECT_EQ(DeviceCheck::asExpected(push.way, *check.direction(push.way)), push.expected) << push.came;
    EXPECT_EQ(check.running(), DeviceCheck::Running::kNothing);
  }
}

TEST(DeviceCheck, AShortOrSlantingPushIsWaitedOn) {
  DeviceCheck check;
  HandledDevice device;
  check.beginDirection(PushedWay::kAway);
  device.tickAt(check, {0.0, 0.0, 0.0});
  device.tickAt(check, {0.0, 14.0, 0.0});
  device.tickAt(check, {25.0, 30.0, 0.0});
  EXPECT_FALSE(check.direction(PushedWay::kAway));
  EXPECT_EQ(check.asked(), PushedWay::kAway);
  device.tickAt(check, {25.0, 55.0, 0.0});
  EXPECT_EQ(axisText(*check.direction(PushedWay::kAway)), "+y");
  EXPECT_FALSE(check.direction(PushedWay::kRight));
}

TEST(DeviceSetup, TheMeasuredReachTakesThePlaceOfTheProfiles) {
  haptic::DeviceProfile profile;
  profile.name = "omega.3";
  EXPECT_EQ(setupKey(profile), "omega.3");
  profile.serial = "10406";
  EXPECT_EQ(setupKey(profile), "omega.3, 10406");
  DeviceSetup setup;
  EXPECT_EQ(setup.in(profile).workspace_radius_mm, profile.workspace_radius_mm);
  setup.reach = DeviceReach{{-10.0, -40.0, -40.0}, {50.0, 40.0, 41.0}};
  EXPECT_DOUBLE_EQ(setup.in(profile).workspace_radius_mm, 30.0);
}

}  // namespace
}  // namespace fettle::app
