// The drivers of makers' libraries, threads and all, on replacements of these libraries that check each call. Nothing here asserts a time:
// things are waited for, with a deadline far beyond any machine's load.
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "haptic/devices/emergency_zero.h"
#include "haptic/devices/enumerate.h"
#include "tests/haptic/devices/fake_vendor/fake_dhd.h"
#include "tests/haptic/devices/fake_vendor/fake_hd.h"
#include "tests/haptic/devices/loop_of_its_own.h"
#include "tests/support/eventually.h"

namespace fettle::haptic {
namespace {

using tests::eventually;
using Loop = tests::LoopOfItsOwn;

template <class Fake>
Fake& fakeOf(const char* file, const char* function) {
  void* const library = dlopen(file, RTLD_NOW | RTLD_LOCAL);
  const auto call = reinterpret_cast<Fake* (*)()>(dlsym(library, function));
  return *call();
}
fake::FakeHd& hd() {
  return fakeOf<fake::FakeHd>(FETTLE_FAKE_HD, "fake_hd");
}
fake::FakeDhd& dhdFake() {
  return fakeOf<fake::FakeDhd>(FETTLE_FAKE_DHD, "fake_dhd");
}

// Both libraries as if they were loaded just now: the process keeps them from test to test.
class MakerLibraryTest : public testing::Test {
 protected:
  void SetUp() override {
    setenv("FETTLE_LIBHD", FETTLE_FAKE_HD, 1);
    setenv("FETTLE_LIBDHD", FETTLE_FAKE_DHD, 1);
    fake::FakeHd& touch = hd();
    touch.plugged = true;
    touch.stalled = touch.garbage = touch.warm = false;
    touch.buttons = 0;
    touch.turned.set({{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}});
    touch.has_gimbal = true;
    touch.nominal_n = 3.3;
    touch.low[1] = -60.0;
    for (fake::Triple* t : {&touch.position, &touch.other_position, &touch.force}) t->set(0.0, 0.0, 0.0);
    touch.rules.forget();
    fake::FakeDhd& omega = dhdFake();
    omega.count = 1;
    omega.stalled = omega.garbage = omega.too_early = false;
    for (auto& unit : omega.units) {
      unit.position.set(0.0, 0.0, 0.0);
      unit.force.set(0.0, 0.0, 0.0);
      unit.buttons = 0;
      unit.turned.set({{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}});
    }
    omega.wrist = false;
    omega.rules.forget();
  }
};
using TouchLibraryTest = MakerLibraryTest;
using ForceDimensionLibraryTest = MakerLibraryTest;
using MakerListTest = MakerLibraryTest;
using FakeLibraryTest = MakerLibraryTest;

std::unique_ptr<Device> opened(const std::string& words) {
  auto device = openDevice(words);
  EXPECT_TRUE(device) << device.error().line();
  return device ? *std::move(device) : nullptr;
}

bool near(const fake::Triple& got, double x, double y, double z) {
  return std::abs(got.x - x) < 1e-9 && std::abs(got.y - y) < 1e-9 && std::abs(got.z - z) < 1e-9;
}
bool near(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::length(a - b) < 1e-9;
}
bool connected(const Loop& loop) {
  return eventually([&] { return loop.input().link == LinkState::kConnected && loop.input().sequence > 0; });
}

std::string allRules(const fake::Rules& rules) {
  std::string text;
  for (const std::string& rule : rules.broken()) text += rule + "; ";
  return text;
}

TEST_F(TouchLibraryTest, TurnsPosesAndForcesIntoTheFrameOfTheDesk) {
  hd().position.set(11.0, 22.0, 33.0);
  hd().low[1] = -40.0;  // the middle of the workspace is 10 mm above the library's zero
  const auto device = opened("touch");
  ASSERT_TRUE(device->start());
  {
    Loop loop(*device);
    loop.setForce({0.5, 1.0, -0.25});  // right, away, down
    ASSERT_TRUE(connected(loop));
    EXPECT_TRUE(eventually([&] { return near(loop.input().position_mm, {11.0, -33.0, 12.0}); }));
    EXPECT_TRUE(eventually([&] { return near(hd().force, 0.5, -0.25, -1.0); }));
    hd().buttons = 3;
    EXPECT_TRUE(eventually([&] { return loop.input().buttons == (kPrimaryButton | kSecondaryButton); }));
  }
  device->stop();
  EXPECT_TRUE(near(hd().force, 0.0, 0.0, 0.0)) << "an explicit zero at the end";
  EXPECT_FALSE(hd().scheduler_runs);
  EXPECT_EQ(hd().open_devices, 0);
  EXPECT_EQ(allRules(hd().rules), "");
}

// The stylus' z in the frame of the desk: x right, y away, z up.
bool points(const Loop& loop, const glm::dvec3& from_tip_to_hand) {
  return eventually([&] {
    const auto& how = loop.input().orientation;
    return how && glm::length(*how * glm::dvec3(0.0, 0.0, 1.0) - from_tip_to_hand) < 1e-9;
  });
}

TEST_F(TouchLibraryTest, SaysHowTheStylusIsHeld) {
  const auto device = opened("touch");
  ASSERT_TRUE(device->start());
  {
    Loop loop(*device);
    ASSERT_TRUE(connected(loop));
    EXPECT_TRUE(points(loop, {0.0, -1.0, 0.0}));  // lying, its tip away from the person
    // A quarter about the library's x, which is right: upright, tip down.
    hd().turned.set({{1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, {0.0, -1.0, 0.0}});
    EXPECT_TRUE(points(loop, {0.0, 0.0, 1.0}));
    // About its y, up, anticlockwise from above: the hand to the right.
    hd().turned.set({{0.0, 0.0, 1.0}, {0.0, 1.0, 0.0}, {-1.0, 0.0, 0.0}});
    EXPECT_TRUE(points(loop, {1.0, 0.0, 0.0}));
    // What is no rotation is no orientation; its pose is one all the same.
    const std::uint64_t bad = device->counters().bad_inputs;
    for (const double wrong : {2.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
      hd().turned.set({{wrong, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}});
      EXPECT_TRUE(eventually([&] { return !loop.input().orientation; })) << wrong;
    }
    hd().turned.set({{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}});
    EXPECT_TRUE(points(loop, {0.0, -1.0, 0.0}));
    hd().has_gimbal = false;
    EXPECT_TRUE(eventually([&] { return !loop.input().orientation; }));
    EXPECT_EQ(device->counters().bad_inputs, bad);
    EXPECT_EQ(loop.input().link, LinkState::kConnected);
  }
  device->stop();
  EXPECT_EQ(allRules(hd().rules), "");  // of which one is that no torque is set
}

TEST_F(ForceDimensionLibraryTest, SaysHowTheStylusIsHeldWhereItHasAWrist) {
  dhdFake().wrist = true;
  const auto device = opened("forcedimension");
  EXPECT_EQ(device->profile().serial, "10406");
  ASSERT_TRUE(device->start());
  {
    Loop loop(*device);
    ASSERT_TRUE(connected(loop));
    EXPECT_TRUE(points(loop, {0.0, -1.0, 0.0}));
    // About the library's y, which is right: upright, tip down.
    dhdFake().units[0].turned.set({{0.0, 0.0, -1.0}, {0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}});
    EXPECT_TRUE(points(loop, {0.0, 0.0, 1.0}));
    // About its z, up, anticlockwise from above.
    dhdFake().units[0].turned.set({{0.0, -1.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}});
    EXPECT_TRUE(points(loop, {1.0, 0.0, 0.0}));
  }
  device->stop();
  EXPECT_EQ(allRules(dhdFake().rules), "");
}

TEST_F(ForceDimensionLibraryTest, WithoutAWristItIsNotAskedHowItIsHeld) {
  const auto device = opened("forcedimension");
  ASSERT_TRUE(device->start());
  {
    Loop loop(*device);
    ASSERT_TRUE(connected(loop));
    EXPECT_FALSE(loop.input().orientation);
  }
  device->stop();
  EXPECT_EQ(allRules(dhdFake().rules), "");
}

TEST_F(TouchLibraryTest, ItsLimitsAreTheTablesAndNeverMoreThanItStates) {
  hd().nominal_n = 2.5;
  const auto device = opened("touch");
  EXPECT_EQ(device->profile().name, "Touch");
  EXPECT_EQ(device->profile().max_force_n, 2.5);
  EXPECT_EQ(device->profile().max_stiffness_n_per_mm, 0.4);
  EXPECT_EQ(device->profile().workspace_radius_mm, 35.0);
  hd().nominal_n = 40.0;
  EXPECT_EQ(opened("touch")->profile().max_force_n, 3.3);
  EXPECT_EQ(allRules(hd().rules), "");
}

TEST_F(TouchLibraryTest, AForceThatIsNotRenewedIsReplacedByZero) {
  const auto device = opened("touch");
  ASSERT_TRUE(device->start());
  Loop loop(*device);
  loop.setForce({1.0, 0.0, 0.0});
  ASSERT_TRUE(eventually([&] { return near(hd().force, 1.0, 0.0, 0.0); }));
  loop.setWrites(false);
  EXPECT_TRUE(eventually([&] { return near(hd().force, 0.0, 0.0, 0.0); }));
  EXPECT_TRUE(eventually([&] { return device->counters().forced_zeros > 0; }));
  loop.setForce({std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0});
  loop.setWrites(true);
  const unsigned long frames = hd().frames;
  EXPECT_TRUE(eventually([&] { return hd().frames > frames + 20; }));
  EXPECT_TRUE(near(hd().force, 0.0, 0.0, 0.0));
  EXPECT_EQ(allRules(hd().rules), "");
}

TEST_F(TouchLibraryTest, UnpluggedItComesBackByItself) {
  const auto device = opened("touch");
  ASSERT_TRUE(device->start());
  Loop loop(*device);
  loop.setForce({1.0, 0.0, 0.0});
  ASSERT_TRUE(connected(loop));
  hd().plugged = false;
  EXPECT_TRUE(eventually([&] { return loop.input().link == LinkState::kDisconnected; }));
  EXPECT_TRUE(eventually([&] { return hd().open_devices == 0; }));
  EXPECT_EQ(loop.input().buttons, 0U);
  hd().plugged = true;
  EXPECT_TRUE(eventually([&] { return loop.input().link == LinkState::kConnected; }));
  EXPECT_TRUE(eventually([&] { return near(hd().force, 1.0, 0.0, 0.0); }));
  EXPECT_EQ(device->counters().connects, 2U);
  EXPECT_EQ(device->counters().disconnects, 1U);
  EXPECT_EQ(allRules(hd().rules), "");
}

TEST_F(TouchLibraryTest, OneThatComesLaterHasTheLimitsOfAnUnknownDevice) {
  hd().plugged = false;
  const auto device = opened("touch");
  EXPECT_EQ(device->profile().max_force_n, DeviceProfile{}.max_force_n);
  EXPECT_TRUE(device->profile().gives_force);
  ASSERT_TRUE(device->start());
  Loop loop(*device);
  hd().plugged = true;
  EXPECT_TRUE(connected(loop));
}

TEST_F(TouchLibraryTest, GarbageIsLeftOutAsIfItHadNotCome) {
  hd().position.set(1.0, 2.0, 3.0);
  const auto device = opened("touch");
  ASSERT_TRUE(device->start());
  Loop loop(*device);
  loop.setForce({1.0, 0.0, 0.0});
  ASSERT_TRUE(connected(loop));
  const glm::dvec3 before = loop.input().position_mm;
  hd().garbage = true;
  EXPECT_TRUE(eventually([&] { return device->counters().bad_inputs > 10; }));
  const std::uint64_t sequence = loop.input().sequence;
  EXPECT_TRUE(eventually([&] { return device->counters().bad_inputs > 30; }));
  EXPECT_EQ(loop.input().sequence, sequence) << "the guard sees that nothing comes";
  EXPECT_TRUE(near(loop.input().position_mm, before));
  hd().garbage = false;
  EXPECT_TRUE(eventually([&] { return loop.input().sequence > sequence; }));
  EXPECT_EQ(allRules(hd().rules), "");
}

TEST_F(TouchLibraryTest, AServoThreadThatStandsIsSeenByTheLoop) {
  const auto device = opened("touch");
  ASSERT_TRUE(device->start());
  {
    Loop loop(*device);
    loop.setForce({1.0, 0.0, 0.0});
    ASSERT_TRUE(eventually([&] { return near(hd().force, 1.0, 0.0, 0.0); }));
    hd().stalled = true;
    EXPECT_TRUE(
        eventually([&] { return loop.input().output_waits_ns > 50'000'000 && loop.input().output_pending; }));
    EXPECT_EQ(loop.input().link, LinkState::kConnected);
    hd().stalled = false;
    EXPECT_TRUE(eventually([&] { return loop.input().output_waits_ns < 10'000'000; }));
    hd().stalled = true;
  }
  device->stop();  // it does not wait for a thread that stands
  EXPECT_EQ(hd().open_devices, 0);
  EXPECT_EQ(allRules(hd().rules), "");
}

TEST_F(TouchLibraryTest, MotorsThatAreTooWarmAreCountedAndItGoesOn) {
  const auto device = opened("touch");
  ASSERT_TRUE(device->start());
  Loop loop(*device);
  hd().warm = true;
  loop.setForce({1.0, 0.0, 0.0});
  ASSERT_TRUE(eventually([&] { return device->counters().faults > 10; }));
  EXPECT_EQ(device->counters().disconnects, 0U);
}

TEST_F(TouchLibraryTest, OfTwoTheNamedOneIsOpened) {
  hd().position.set(1.0, 1.0, 1.0);
  hd().other_position.set(7.0, 8.0, 9.0);
  const auto device = opened("touch:right");
  ASSERT_TRUE(device->start());
  Loop loop(*device);
  ASSERT_TRUE(connected(loop));
  EXPECT_TRUE(near(loop.input().position_mm, {7.0, -9.0, 8.0}));
}

TEST_F(TouchLibraryTest, WhatIsHeldAtZeroGivesZero) {
  const auto device = opened("touch");
  ASSERT_TRUE(device->start());
  Loop loop(*device);
  loop.setForce({1.0, 0.0, 0.0});
  ASSERT_TRUE(eventually([&] { return near(hd().force, 1.0, 0.0, 0.0); }));
  holdDevicesAtZero(HeldAtZero::kYes);
  EXPECT_EQ(waitForHeldZeros(), 0) << "the program's end waits for its thread";
  EXPECT_TRUE(near(hd().force, 0.0, 0.0, 0.0));
  holdDevicesAtZero(HeldAtZero::kNo);
  EXPECT_TRUE(eventually([&] { return near(hd().force, 1.0, 0.0, 0.0); }));
}

TEST_F(ForceDimensionLibraryTest, TurnsPosesAndForcesIntoTheFrameOfTheDesk) {
  dhdFake().units[0].position.set(0.011, 0.022, 0.033);  // towards the user, right, up
  const auto device = opened("forcedimension");
  EXPECT_EQ(device->profile().name, "omega.3");
  EXPECT_EQ(device->profile().max_force_n, 12.0);
  ASSERT_TRUE(device->start());
  {
    Loop loop(*device);
    loop.setForce({0.5, 1.0, -0.25});  // right, away, down
    ASSERT_TRUE(connected(loop));
    EXPECT_TRUE(eventually([&] { return near(loop.input().position_mm, {22.0, -11.0, 33.0}); }));
    EXPECT_TRUE(eventually([&] { return near(dhdFake().units[0].force, -1.0, 0.5, -0.25); }));
    dhdFake().units[0].buttons = 2;
    EXPECT_TRUE(eventually([&] { return loop.input().buttons == kSecondaryButton; }));
  }
  device->stop();
  EXPECT_TRUE(near(dhdFake().units[0].force, 0.0, 0.0, 0.0)) << "an explicit zero at the end";
  EXPECT_FALSE(dhdFake().units[0].open);
  EXPECT_EQ(allRules(dhdFake().rules), "");
}

TEST_F(ForceDimensionLibraryTest, AForceThatIsNotRenewedIsReplacedByZero) {
  const auto device = opened("forcedimension");
  ASSERT_TRUE(device->start());
  Loop loop(*device);
  loop.setForce({1.0, 0.0, 0.0});
  ASSERT_TRUE(eventually([&] { return near(dhdFake().units[0].force, 0.0, 1.0, 0.0); }));
  loop.setWrites(false);
  EXPECT_TRUE(eventually([&] { return near(dhdFake().units[0].force, 0.0, 0.0, 0.0); }));
  EXPECT_EQ(allRules(dhdFake().rules), "");
}

TEST_F(ForceDimensionLibraryTest, UnpluggedItComesBackByItself) {
  const auto device = opened("forcedimension");
  ASSERT_TRUE(device->start());
  Loop loop(*device);
  loop.setForce({1.0, 0.0, 0.0});
  ASSERT_TRUE(connected(loop));
  dhdFake().count = 0;
  EXPECT_TRUE(eventually([&] { return loop.input().link == LinkState::kDisconnected; }));
  EXPECT_TRUE(eventually([&] { return !dhdFake().units[0].open; }));
  dhdFake().count = 1;
  EXPECT_TRUE(eventually([&] { return loop.input().link == LinkState::kConnected; }));
  EXPECT_EQ(device->counters().connects, 2U);
  EXPECT_EQ(allRules(dhdFake().rules), "");
}

TEST_F(ForceDimensionLibraryTest, GarbageIsLeftOutAsIfItHadNotCome) {
  const auto device = opened("forcedimension");
  ASSERT_TRUE(device->start());
  Loop loop(*device);
  loop.setForce({1.0, 0.0, 0.0});
  ASSERT_TRUE(eventually([&] { return near(dhdFake().units[0].force, 0.0, 1.0, 0.0); }));
  dhdFake().garbage = true;
  EXPECT_TRUE(eventually([&] { return device->counters().bad_inputs > 10; }));
  const std::uint64_t sequence = loop.input().sequence;
  EXPECT_TRUE(eventually([&] { return device->counters().bad_inputs > 30; }));
  EXPECT_EQ(loop.input().sequence, sequence) << "the guard sees that nothing comes";
  EXPECT_EQ(loop.input().link, LinkState::kConnected) << "calls that answer are no unplugging";
  dhdFake().garbage = false;
  EXPECT_TRUE(eventually([&] { return loop.input().sequence > sequence; }));
  EXPECT_EQ(allRules(dhdFake().rules), "");
}

TEST_F(ForceDimensionLibraryTest, ACallThatBlocksIsSeenByTheLoopAndHoldsNothingUp) {
  const auto device = opened("forcedimension");
  ASSERT_TRUE(device->start());
  Loop loop(*device);
  loop.setForce({1.0, 0.0, 0.0});
  ASSERT_TRUE(eventually([&] { return near(dhdFake().units[0].force, 0.0, 1.0, 0.0); }));
  dhdFake().stalled = true;
  EXPECT_TRUE(eventually([&] { return loop.input().output_waits_ns > 50'000'000; }));
  dhdFake().stalled = false;
  EXPECT_TRUE(eventually([&] { return loop.input().output_waits_ns < 10'000'000; }));
  dhdFake().too_early = true;  // the library skips forces: no error
  const unsigned long exchanges = dhdFake().exchanges;
  EXPECT_TRUE(eventually([&] { return dhdFake().exchanges > exchanges + 50; }));
  EXPECT_EQ(loop.input().link, LinkState::kConnected);
  EXPECT_EQ(allRules(dhdFake().rules), "");
}

TEST_F(ForceDimensionLibraryTest, OfTwoTheNumberedOneIsOpened) {
  dhdFake().count = 2;
  dhdFake().units[1].position.set(0.001, 0.002, 0.003);
  const auto device = opened("forcedimension:1");
  ASSERT_TRUE(device->start());
  Loop loop(*device);
  ASSERT_TRUE(connected(loop));
  EXPECT_TRUE(near(loop.input().position_mm, {2.0, -1.0, 3.0}));
  EXPECT_FALSE(dhdFake().units[0].open);
  EXPECT_FALSE(openDevice("forcedimension:left"));
}

TEST_F(MakerListTest, SaysWhatTheirLibrariesAnswer) {
  dhdFake().count = 2;
  hd().plugged = false;
  const auto makers = listMakers();
  ASSERT_EQ(makers.size(), 3U);
  EXPECT_EQ(makers[0].word, "touch");
  EXPECT_EQ(makers[0].problem, "");
  ASSERT_EQ(makers[0].devices.size(), 1U);
  EXPECT_NE(makers[0].devices[0].answer.find("communication error: error 0x0302"), std::string::npos)
      << makers[0].devices[0].answer;
  ASSERT_EQ(makers[1].devices.size(), 2U);
  EXPECT_EQ(makers[1].devices[1].path, "forcedimension:1");
  EXPECT_EQ(makers[1].devices[1].answer, "");
  EXPECT_EQ(makers[1].devices[1].profile.workspace_radius_mm, 75.0);
  EXPECT_EQ(allRules(hd().rules) + allRules(dhdFake().rules), "");
}

template <class Call>
Call call(const char* file, const char* name) {
  return reinterpret_cast<Call>(dlsym(dlopen(file, RTLD_NOW | RTLD_LOCAL), name));
}

// The replacements notice what is against the rules: each of these calls is.
TEST_F(FakeLibraryTest, NoticesWhatIsAgainstTheRules) {
  const double strong[3] = {40.0, 0.0, 0.0};
  call<void (*)()>(FETTLE_FAKE_HD, "hdStartScheduler")();
  call<void (*)(unsigned, const double*)>(FETTLE_FAKE_HD, "hdSetDoublev")(0x2700, strong);
  call<void (*)(unsigned)>(FETTLE_FAKE_HD, "hdEndFrame")(0);
  const auto stop = call<void (*)()>(FETTLE_FAKE_HD, "hdStopScheduler");
  stop();
  stop();
  call<void (*)(unsigned)>(FETTLE_FAKE_HD, "hdDisableDevice")(0);
  call<void (*)(unsigned long)>(FETTLE_FAKE_HD, "hdUnschedule")(5);
  const std::string said = allRules(hd().rules);
  for (const char* rule :
       {"a device is open before the scheduler starts", "a force is set within a frame",
        "force is switched on before one is set", "a force is within what the device states",
        "the frame that is ended was begun", "the scheduler that is stopped runs", "what is closed is open",
        "by the number it was given"})
    EXPECT_NE(said.find(rule), std::string::npos) << rule;
  const auto set = call<int (*)(double, double, double, char)>(FETTLE_FAKE_DHD, "dhdSetForce");
  const auto open = call<int (*)(char)>(FETTLE_FAKE_DHD, "dhdOpenID");
  const auto close = call<int (*)(char)>(FETTLE_FAKE_DHD, "dhdClose");
  set(0.0, 40.0, 0.0, 0);
  open(0);
  open(0);
  set(0.0, 1.0, std::numeric_limits<double>::quiet_NaN(), 0);
  set(0.0, 1.0, 0.0, 0);
  close(0);
  close(0);
  const std::string heard = allRules(dhdFake().rules);
  for (const char* rule : {"a device is open before it is used", "a device is opened once",
                           "force is switched on before one is set", "a force is finite",
                           "a force is within what the device gives",
                           "the last force before a device is closed is zero", "what is closed is open"})
    EXPECT_NE(heard.find(rule), std::string::npos) << rule;
}

}  // namespace
}  // namespace fettle::haptic
