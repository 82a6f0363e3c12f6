// The driver of the Inverse3, threads and all, on a replacement of its service that was written apart from it and checks each message.
// Nothing here asserts a time: things are waited for, with a deadline far beyond any machine's load.
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "haptic/devices/emergency_zero.h"
#include "haptic/devices/enumerate.h"
#include "tests/haptic/devices/fake_vendor/fake_inverse_service.h"
#include "tests/haptic/devices/loop_of_its_own.h"
#include "tests/support/eventually.h"

namespace fettle::haptic {
namespace {

using fake::FakeInverseService;
using fake::InverseAnswer;
using fake::InverseForm;
using tests::eventually;
using Loop = tests::LoopOfItsOwn;

class Inverse3Test : public testing::TestWithParam<InverseForm> {
 protected:
  void SetUp() override {
    setenv("FETTLE_INVERSE3", service_.address().c_str(), 1);
    service_.change([](auto& w) { w.form = GetParam(); });
  }
  void answer(InverseAnswer how) {
    service_.change([how](auto& w) { w.answer = how; });
  }
  // Started, with a loop that sends this force.
  void run(const glm::dvec3& force = {0.0, 0.0, 1.0}, const std::string& words = "inverse3") {
    auto opened = openDevice(words);
    ASSERT_TRUE(opened) << opened.error().line();
    device_ = *std::move(opened);
    ASSERT_TRUE(device_->start());
    loop_ = std::make_unique<Loop>(*device_);
    loop_->setForce(force);
  }
  [[nodiscard]] bool gives(double z) const {
    return eventually([&] { return service_.received().force_n[2] == z; });
  }
  [[nodiscard]] bool isAt(LinkState state) const {
    return eventually([&] { return loop_->input().link == state; });
  }
  // Poses come.
  [[nodiscard]] bool goesOn() const {
    const std::uint64_t from = loop_->input().sequence;
    return eventually([&] { return loop_->input().sequence > from + 5; });
  }
  void end() {
    loop_.reset();
    device_->stop();
    EXPECT_TRUE(eventually([&] { return service_.received().connections == 0; }));
    EXPECT_EQ(glm::length(glm::dvec3(service_.received().force_n[0], service_.received().force_n[1],
                                     service_.received().force_n[2])),
              0.0)
        << "an explicit zero at the end";
    EXPECT_EQ(broken(), "");
  }
  [[nodiscard]] std::string broken() const {
    std::string text;
    for (const std::string& rule : service_.rules.broken()) text += rule + "; ";
    return text;
  }

  FakeInverseService service_;
  std::unique_ptr<Device> device_;
  std::unique_ptr<Loop> loop_;  // ends before the device
};
INSTANTIATE_TEST_SUITE_P(Forms, Inverse3Test, testing::Values(InverseForm::k31, InverseForm::k35),
                         [](const auto& i) { return i.param == InverseForm::k31 ? "v31" : "v35"; });

// The service's axes are the desk's: x to the right, y away, z up. Its metres are counted from the base, behind and below the tip.
TEST_P(Inverse3Test, TurnsPosesAndForcesIntoTheFrameOfTheDesk) {
  service_.change([](auto& w) { w.units[0].position_m = {0.011, -0.14 + 0.022, 0.20 - 0.033}; });
  run({0.5, 1.0, -0.25});
  EXPECT_TRUE(isAt(LinkState::kConnected));
  EXPECT_TRUE(eventually(
      [&] { return glm::length(loop_->input().position_mm - glm::dvec3(11.0, 22.0, -33.0)) < 1e-9; }));
  EXPECT_TRUE(eventually([&] {
    return service_.received().force_n == std::array<double, 3>{0.5, 1.0, -0.25};
  }));
  service_.change([](auto& w) { w.units[0].b = true; });
  EXPECT_TRUE(eventually([&] { return loop_->input().buttons == kSecondaryButton; }));
  service_.change([](auto& w) { w.units[0].a = true; });
  EXPECT_TRUE(eventually([&] { return loop_->input().buttons == (kPrimaryButton | kSecondaryButton); }));
  end();
}

TEST_P(Inverse3Test, SaysHowTheGripIsHeld) {
  run({0.0, 0.0, 0.0});
  const auto points = [&](const glm::dvec3& from_tip_to_hand) {
    return eventually([&] {
      const auto& how = loop_->input().orientation;
      return how && glm::length(*how * glm::dvec3(0.0, 0.0, 1.0) - from_tip_to_hand) < 1e-9;
    });
  };
  EXPECT_TRUE(points({0.0, -1.0, 0.0}));  // lying, its tip away from the person
  const double half = std::sqrt(0.5);
  service_.change([&](auto& w) { w.units[0].orientation_wxyz = {half, 0.0, 0.0, half}; });  // about z
  EXPECT_TRUE(points({1.0, 0.0, 0.0}));
  service_.change([&](auto& w) { w.units[0].orientation_wxyz = {half, -half, 0.0, 0.0}; });  // about x
  EXPECT_TRUE(points({0.0, 0.0, 1.0}));
  service_.change([](auto& w) { w.units[0].orientation_wxyz = {0.0, 0.0, 0.0, 0.0}; });
  EXPECT_TRUE(eventually([&] { return !loop_->input().orientation; }));
  service_.change([](auto& w) { w.units[0].has_grip = false; });
  EXPECT_TRUE(goesOn());
  EXPECT_FALSE(loop_->input().orientation);
  end();
}

TEST_P(Inverse3Test, AForceThatIsNotRenewedIsReplacedByZero) {
  run();
  ASSERT_TRUE(gives(1.0) && goesOn());
  loop_->setWrites(false);
  EXPECT_TRUE(gives(0.0));
  EXPECT_TRUE(eventually([&] { return device_->counters().forced_zeros > 0; }));
  loop_->setWrites(true);
  EXPECT_TRUE(gives(1.0));
  loop_->setForce({0.0, 0.0, 9.0});  // beyond what is known of the device
  EXPECT_TRUE(gives(3.0));
  end();
}

TEST_P(Inverse3Test, ADeviceThatVanishesComesBackByItself) {
  run();
  ASSERT_TRUE(gives(1.0) && goesOn());
  service_.change([](auto& w) { w.units.clear(); });
  EXPECT_TRUE(isAt(LinkState::kDisconnected));
  EXPECT_EQ(loop_->input().buttons, 0U);
  service_.change([](auto& w) { w.units.push_back({}); });
  EXPECT_TRUE(isAt(LinkState::kConnected));
  EXPECT_TRUE(goesOn());
  EXPECT_TRUE(gives(1.0));
  EXPECT_EQ(device_->counters().connects, 2U);
  end();
}

TEST_P(Inverse3Test, AServiceThatEndsComesBackByItself) {
  run();
  ASSERT_TRUE(gives(1.0) && goesOn());
  service_.stop();
  EXPECT_TRUE(isAt(LinkState::kDisconnected));
  service_.forgetReceived();
  service_.start();
  EXPECT_TRUE(isAt(LinkState::kConnected));
  EXPECT_TRUE(gives(1.0));
  // Each way in which a connection can end, or be refused.
  for (const InverseAnswer end : {InverseAnswer::kCloses, InverseAnswer::kDrops, InverseAnswer::kLong}) {
    answer(end);
    const int before = service_.received().ever_connected;
    EXPECT_TRUE(eventually([&] { return service_.received().ever_connected > before; }));
    answer(InverseAnswer::kState);
    EXPECT_TRUE(goesOn()) << static_cast<int>(end);
  }
  service_.change([](auto& w) {
    w.refuses = true;
    w.answer = InverseAnswer::kCloses;
  });
  EXPECT_TRUE(isAt(LinkState::kDisconnected));
  service_.forgetReceived();  // the force of a connection that the service broke
  service_.change([](auto& w) {
    w.refuses = false;
    w.answer = InverseAnswer::kState;
  });
  EXPECT_TRUE(gives(1.0));
  end();
}

TEST_P(Inverse3Test, AnAnswerWithoutAPoseIsLeftOut) {
  run();
  ASSERT_TRUE(gives(1.0) && goesOn());
  const glm::dvec3 before = loop_->input().position_mm;
  for (const InverseAnswer wrong :
       {InverseAnswer::kNotJson, InverseAnswer::kCutShort, InverseAnswer::kNoState,
        InverseAnswer::kNoPosition, InverseAnswer::kHuge, InverseAnswer::kNull, InverseAnswer::kWords}) {
    answer(wrong);
    const std::uint64_t bad = device_->counters().bad_inputs;
    EXPECT_TRUE(eventually([&] { return device_->counters().bad_inputs > bad + 5; }))
        << static_cast<int>(wrong);
    const std::uint64_t sequence = loop_->input().sequence;
    EXPECT_TRUE(eventually([&] { return device_->counters().bad_inputs > bad + 15; }));
    EXPECT_EQ(loop_->input().sequence, sequence) << "the guard sees that nothing comes";
    EXPECT_EQ(loop_->input().position_mm, before);
    answer(InverseAnswer::kState);
    EXPECT_TRUE(goesOn()) << static_cast<int>(wrong);
  }
  EXPECT_EQ(device_->counters().disconnects, 0U);
  end();
}

TEST_P(Inverse3Test, TheStateOfAnotherDeviceIsNotTaken) {
  service_.change([](auto& w) { w.units[0].position_m = {0.05, -0.14, 0.20}; });
  run();
  ASSERT_TRUE(gives(1.0) && goesOn());
  answer(InverseAnswer::kOtherDevice);
  service_.change([](auto& w) { w.units[0].position_m = {0.09, -0.14, 0.20}; });
  EXPECT_TRUE(isAt(LinkState::kDisconnected));
  EXPECT_NEAR(loop_->input().position_mm.x, 50.0, 1e-9);
  answer(InverseAnswer::kState);
  EXPECT_TRUE(isAt(LinkState::kConnected));
  end();
}

TEST_P(Inverse3Test, AServiceThatStandsIsSeenByTheLoop) {
  run();
  ASSERT_TRUE(gives(1.0) && goesOn());
  answer(InverseAnswer::kNothing);
  EXPECT_TRUE(eventually(
      [&] { return loop_->input().output_waits_ns > 50'000'000 && loop_->input().output_pending; }));
  answer(InverseAnswer::kState);
  EXPECT_TRUE(goesOn());
  EXPECT_TRUE(eventually([&] { return loop_->input().output_waits_ns < 10'000'000; }));
  EXPECT_TRUE(gives(1.0));
  // Permanently: the connection is given up, and the end does not wait for it.
  answer(InverseAnswer::kHugeFrame);
  EXPECT_TRUE(isAt(LinkState::kDisconnected));
  loop_.reset();
  device_->stop();
}

TEST_P(Inverse3Test, SlowAnswersSlowNothingButTheExchange) {
  service_.change([](auto& w) { w.slowness = std::chrono::milliseconds(5); });
  run();
  EXPECT_TRUE(gives(1.0));
  EXPECT_TRUE(goesOn());
  EXPECT_EQ(loop_->input().link, LinkState::kConnected);
  end();
}

// Poses that queue up would grow older with each answer: each one too many is dropped, and counted.
TEST_P(Inverse3Test, TwoAnswersForOneMessageDoNotQueueUp) {
  run();
  ASSERT_TRUE(gives(1.0) && goesOn());
  answer(InverseAnswer::kTwice);
  EXPECT_TRUE(eventually([&] { return device_->counters().bad_inputs > 200; }));
  service_.change([](auto& w) { w.units[0].position_m = {0.03, -0.14, 0.20}; });
  EXPECT_TRUE(eventually([&] { return std::abs(loop_->input().position_mm.x - 30.0) < 1e-9; }));
  answer(InverseAnswer::kState);
  EXPECT_TRUE(goesOn());
  end();
}

TEST_P(Inverse3Test, APingAndAnAnswerInPiecesAreUnderstood) {
  answer(InverseAnswer::kInPieces);
  run();
  EXPECT_TRUE(gives(1.0));
  EXPECT_TRUE(goesOn());
  EXPECT_EQ(device_->counters().bad_inputs, 0U);
  end();
}

TEST_P(Inverse3Test, WithoutItsCalibrationItGivesNoForceAndGoesOnAfterIt) {
  service_.change([](auto& w) { w.units[0].calibrated = false; });
  run();
  EXPECT_TRUE(isAt(LinkState::kUncalibrated));
  EXPECT_TRUE(goesOn());
  EXPECT_EQ(service_.received().strongest_n, 0.0);
  service_.change([](auto& w) { w.units[0].calibrated = true; });
  EXPECT_TRUE(isAt(LinkState::kConnected));
  EXPECT_TRUE(gives(1.0));
  end();
}

TEST_P(Inverse3Test, OfTwoTheNamedOneIsOpened) {
  service_.change([](auto& w) {
    w.units.push_back({});
    w.units[1].id = "04BA";
    w.units[1].position_m = {0.07, -0.14, 0.20};
  });
  run({0.0, 0.0, 1.0}, "inverse3:04BA");
  EXPECT_TRUE(eventually([&] { return service_.received().other_force_n[2] == 1.0; }));
  EXPECT_TRUE(goesOn());
  EXPECT_NEAR(loop_->input().position_mm.x, 70.0, 1e-9);
  EXPECT_EQ(service_.received().strongest_n, 0.0) << "the other one";
  // The order of a message is not the order of the devices.
  service_.change([](auto& w) { std::swap(w.units[0], w.units[1]); });
  EXPECT_TRUE(goesOn());
  EXPECT_NEAR(loop_->input().position_mm.x, 70.0, 1e-9);
  loop_.reset();
  device_->stop();
  EXPECT_EQ(service_.received().force_n[2], 0.0);
  EXPECT_EQ(broken(), "");
}

TEST_P(Inverse3Test, WhatIsHeldAtZeroGivesZero) {
  run();
  ASSERT_TRUE(gives(1.0) && goesOn());
  holdDevicesAtZero(HeldAtZero::kYes);
  // The handler of a signal waits 20 ms; a machine may be held up for longer.
  EXPECT_TRUE(gives(0.0));
  EXPECT_EQ(waitForHeldZeros(), 0);
  holdDevicesAtZero(HeldAtZero::kNo);
  EXPECT_TRUE(gives(1.0));
  end();
}

TEST_P(Inverse3Test, IsListedByWhatTheServiceStates) {
  service_.change([](auto& w) {
    w.units.push_back({});
    w.units[1].id = "04BA";
    w.units[1].calibrated = false;
  });
  const MakerInfo maker = listMakers().at(2);
  EXPECT_EQ(maker.problem, "");
  ASSERT_EQ(maker.devices.size(), 2U);
  EXPECT_EQ(maker.devices[0].path, "inverse3:049D");
  EXPECT_EQ(maker.devices[0].advice, "");
  EXPECT_EQ(maker.devices[1].path, "inverse3:04BA");
  EXPECT_NE(maker.devices[1].advice.find("calibrate"), std::string::npos);
  EXPECT_TRUE(eventually([&] { return service_.received().connections == 0; }));
  EXPECT_EQ(service_.received().messages, 0U);
  EXPECT_EQ(broken(), "");
  for (const bool silent : {false, true}) {
    service_.change([silent](auto& w) {
      w.refuses = !silent;
      w.is_silent = silent;
    });
    EXPECT_NE(listMakers().at(2).problem, "");
  }
  service_.stop();
  EXPECT_NE(listMakers().at(2).remedy.find("Haply Inverse Service"), std::string::npos);
}

}  // namespace
}  // namespace fettle::haptic
