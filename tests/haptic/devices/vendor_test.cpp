// Devices behind their makers' software: what leaves for one, and the messages of one, without any of it.
#include <chrono>
#include <limits>
#include <mutex>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "engine/base/stopwatch.h"
#include "haptic/devices/vendor/inverse3_codec.h"
#include "haptic/devices/vendor/linked_device.h"

namespace fettle::haptic {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// One exchange: what would be sent now.
glm::dvec3 sendsNow(ExchangeSlots& slots) {
  const glm::dvec3 force = slots.forceToSend();
  slots.sent();
  return force;
}

TEST(ExchangeSlots, AForceLeavesOnlyForADeviceThatIsConnectedAndCalibrated) {
  ExchangeSlots slots;
  slots.start();
  slots.write({0.0, 0.0, 1.0});
  EXPECT_EQ(sendsNow(slots), glm::dvec3(0.0));
  slots.opened(LinkState::kUncalibrated, 5.0);
  slots.write({0.0, 0.0, 1.0});
  EXPECT_EQ(sendsNow(slots), glm::dvec3(0.0));
  slots.setState(LinkState::kConnected);
  slots.write({0.0, 0.0, 1.0});
  EXPECT_EQ(sendsNow(slots), glm::dvec3(0.0, 0.0, 1.0));
  slots.lost();
  slots.write({0.0, 0.0, 1.0});
  EXPECT_EQ(sendsNow(slots), glm::dvec3(0.0));
}

TEST(ExchangeSlots, AForceIsNeverMoreThanTheDeviceStatesAndKeepsItsDirection) {
  ExchangeSlots slots;
  slots.start();
  slots.opened(LinkState::kConnected, 2.0);
  slots.write({3.0, 0.0, 4.0});
  const glm::dvec3 force = sendsNow(slots);
  EXPECT_NEAR(force.x, 1.2, 1e-12);
  EXPECT_NEAR(force.z, 1.6, 1e-12);
  EXPECT_EQ(slots.counters().scaled_forces, 1U);
  for (const double limit : {kNaN, -1.0, 0.0}) {
    slots.opened(LinkState::kConnected, limit);
    slots.write({3.0, 0.0, 4.0});
    EXPECT_EQ(sendsNow(slots), glm::dvec3(0.0)) << limit;
  }
  slots.opened(LinkState::kConnected, 2.0);
  slots.write({kNaN, 0.0, 1.0});
  EXPECT_EQ(sendsNow(slots), glm::dvec3(0.0));
}

TEST(ExchangeSlots, AForceThatIsNotRenewedIsReplacedByZero) {
  ExchangeSlots slots;
  slots.start();
  slots.opened(LinkState::kConnected, 5.0);
  slots.write({0.0, 0.0, 1.0});
  slots.waitForForce(engine::steadyNs());  // takes the wake-up of the write
  slots.waitForForce(engine::steadyNs() + 11'000'000);
  EXPECT_EQ(sendsNow(slots), glm::dvec3(0.0));
  EXPECT_EQ(slots.counters().forced_zeros, 1U);
}

TEST(ExchangeSlots, StoppingAndAFatalSignalSendZerosOnly) {
  ExchangeSlots slots;
  slots.start();
  slots.opened(LinkState::kConnected, 5.0);
  slots.write({0.0, 0.0, 1.0});
  EXPECT_EQ(sendsNow(slots).z, 1.0);
  holdDevicesAtZero(HeldAtZero::kYes);
  EXPECT_EQ(waitForHeldZeros(), 1);  // no exchange since: after 20 ms nothing more can be done
  slots.write({0.0, 0.0, 1.0});
  EXPECT_EQ(sendsNow(slots), glm::dvec3(0.0));
  EXPECT_EQ(waitForHeldZeros(), 0);
  holdDevicesAtZero(HeldAtZero::kNo);
  slots.write({0.0, 0.0, 1.0});
  EXPECT_EQ(sendsNow(slots).z, 1.0);
  slots.requestStop();
  slots.write({0.0, 0.0, 1.0});
  EXPECT_EQ(sendsNow(slots), glm::dvec3(0.0));
  slots.lost();
  EXPECT_EQ(waitForHeldZeros(), 0);
}

TEST(ExchangeSlots, PosesThatCannotBeAreLeftOut) {
  ExchangeSlots slots;
  slots.start();
  slots.opened(LinkState::kConnected, 5.0);
  slots.takeInput({1.0, 2.0, 3.0}, 2);
  for (const double wrong : {kNaN, std::numeric_limits<double>::infinity(), 1e30, -2001.0})
    slots.takeInput({0.0, wrong, 0.0}, 1);
  const DeviceInput input = slots.read();
  EXPECT_EQ(input.position_mm, glm::dvec3(1.0, 2.0, 3.0));
  EXPECT_EQ(input.buttons, 2U);
  EXPECT_EQ(input.sequence, 1U);
  EXPECT_EQ(slots.counters().bad_inputs, 4U);
}

TEST(ExchangeSlots, ARunningExchangeIsSeenAsWaiting) {
  ExchangeSlots slots;
  slots.start();
  slots.opened(LinkState::kConnected, 5.0);
  slots.write({0.0, 0.0, 1.0});
  EXPECT_TRUE(slots.read().output_pending);
  static_cast<void>(slots.forceToSend());
  EXPECT_GT(slots.read().output_waits_ns, 0);
  slots.sent();
  EXPECT_EQ(slots.read().output_waits_ns, 0);
  EXPECT_FALSE(slots.read().output_pending);
}

TEST(ExchangeSlots, ACalibrationThatWasAskedForBeforeADeviceCameIsNotDoneOnIt) {
  ExchangeSlots slots;
  slots.start();
  slots.requestCalibration();
  slots.opened(LinkState::kUncalibrated, 5.0);
  EXPECT_FALSE(slots.takeCalibrationRequest());
  slots.requestCalibration();
  EXPECT_TRUE(slots.takeCalibrationRequest());
  EXPECT_FALSE(slots.takeCalibrationRequest()) << "once";
}

TEST(ExchangeSlots, ADeviceThatIsStartedAgainGivesForceAgain) {
  ExchangeSlots slots;
  for (int time = 0; time < 2; ++time) {
    slots.start();
    slots.opened(LinkState::kConnected, 5.0);
    slots.write({0.0, 0.0, 1.0});
    EXPECT_EQ(sendsNow(slots).z, 1.0) << time;
    slots.requestStop();
    slots.write({0.0, 0.0, 1.0});
    EXPECT_EQ(sendsNow(slots), glm::dvec3(0.0)) << time;
    slots.lost();
  }
}

TEST(ExchangeSlots, WhatLeftAndWhatDidNotIsCounted) {
  ExchangeSlots slots;
  slots.start();
  slots.opened(LinkState::kConnected, 5.0);
  for (int i = 0; i < 3; ++i) {
    slots.write({0.0, 0.0, 1.0});
    static_cast<void>(sendsNow(slots));
  }
  slots.write({0.0, 0.0, 1.0});
  static_cast<void>(slots.forceToSend());
  slots.notSent();
  EXPECT_TRUE(slots.read().output_pending) << "what did not leave is still to be sent";
  EXPECT_EQ(slots.counters().outputs, 3U);
  EXPECT_EQ(slots.counters().failed_outputs, 1U);
}

// A library call that does not return before it is let go.
class Hanging final : public Counterpart {
 public:
  explicit Hanging(std::shared_ptr<std::mutex> gate) : gate_(std::move(gate)) {}
  void serve(ExchangeSlots& slots) noexcept override {
    slots.opened(LinkState::kConnected, 5.0);
    const std::lock_guard held(*gate_);
  }

 private:
  std::shared_ptr<std::mutex> gate_;
};

TEST(LinkedDevice, ACallThatHangsHoldsUpNobodyForLong) {
  const auto gate = std::make_shared<std::mutex>();
  std::unique_lock held(*gate);
  LinkedDevice device(DeviceProfile{}, std::make_unique<Hanging>(gate), 50'000'000);
  ASSERT_TRUE(device.start());
  while (device.counters().connects == 0) std::this_thread::yield();
  const engine::Stopwatch watch;
  device.stop();
  EXPECT_GE(watch.ms(), 50.0);
  const engine::Status again = device.start();
  ASSERT_FALSE(again);
  EXPECT_NE(again.error().what.find("has not returned"), std::string::npos);
  held.unlock();
  engine::Status status = again;
  while (!status) status = device.start();
  device.stop();
}

TEST(Inverse3Codec, TakesTheStateOfEachDeviceAndTheButtonsOfTheGrip) {
  const auto message = decodeInverse3(
      R"({"inverse3":[{"device_id":"A","status":{"calibrated":false},"state":{"cursor_position":{"x":0.1,"y":-2,"z":3e-1}}},
                      {"device_id":"B","state":{}}],
          "wireless_verse_grip":[{"device_id":"G","state":{"buttons":{"a":true,"b":false,"c":true}}}]})");
  ASSERT_TRUE(message);
  ASSERT_EQ(message->devices.size(), 2U);
  EXPECT_EQ(message->devices[0].device_id, "A");
  EXPECT_EQ(*message->devices[0].position_m, glm::dvec3(0.1, -2.0, 0.3));
  EXPECT_FALSE(*message->devices[0].calibrated);
  EXPECT_FALSE(message->devices[1].position_m);
  EXPECT_FALSE(message->devices[1].calibrated);
  EXPECT_EQ(message->buttons, 5U);
  EXPECT_EQ(decodeInverse3(R"({"inverse3":[],"verse_grip":[{"state":{"button":true}}]})")->buttons, 1U);
}

TEST(Inverse3Codec, WhatIsNoMessageIsRefused) {
  for (const char* wrong : {"", "{", "[]", "null", "1", R"({"inverse3":{}})", R"({"inverse3":[1]})",
                            R"({"inverse3":[{"device_id":7}]})", R"({"inverse3":[{}]})", "\xff\xfe"})
    EXPECT_FALSE(decodeInverse3(wrong)) << wrong;
  for (const char* no_pose :
       {R"({"x":1,"y":2})", R"({"x":"1","y":2,"z":3})", R"({"x":null,"y":2,"z":3})", R"([1,2,3])", "7"}) {
    const auto message = decodeInverse3(R"({"inverse3":[{"device_id":"A","state":{"cursor_position":)" +
                                        std::string(no_pose) + "}}]}");
    ASSERT_TRUE(message) << no_pose;
    EXPECT_FALSE(message->devices[0].position_m) << no_pose;
  }
}

TEST(Inverse3Codec, BrokenMessagesAreRefusedOrReadAndNeverMore) {
  const std::string whole =
      R"({"inverse3":[{"device_id":"A","state":{"cursor_position":{"x":0.1,"y":0.2,"z":0.3}}}]})";
  std::minstd_rand random(7);
  for (int i = 0; i < 2000; ++i) {
    std::string broken = whole;
    for (int k = 0; k < 3; ++k) broken[random() % broken.size()] = static_cast<char>(random() % 256);
    broken.resize(1 + random() % broken.size());
    if (const auto message = decodeInverse3(broken))
      for (const Inverse3State& state : message->devices)
        if (state.position_m) {
          EXPECT_TRUE(std::isfinite(state.position_m->x));
        }
  }
}

TEST(Inverse3Codec, AForceIsSentAsTheServiceNamesIt) {
  using nlohmann::json;
  const char* const force = R"({"x":0.5,"y":-1,"z":2})";
  for (const char* name : {"values", "vector"}) {
    const bool is_newer = name == std::string("vector");
    const Inverse3Form form =
        decodeInverse3(is_newer ? R"({"session_id":7,"inverse3":[]})" : R"({"inverse3":[]})")->form;
    EXPECT_EQ(json::parse(encodeInverse3(form, "A\"7", {0.5, -1.0, 2.0})),
              json::parse(R"({"inverse3":[{"device_id":"A\"7","commands":{"set_cursor_force":{")" +
                          std::string(name) + "\":" + force + "}}}]}"));
  }
  const json full =
      json::parse(encodeInverse3(Inverse3Form::kValues, "A", {0, 0, 0}, Inverse3Asks::kFullState));
  EXPECT_EQ(full["session"], json::parse(R"({"force_render_full_state":{}})"));
}

}  // namespace
}  // namespace fettle::haptic
