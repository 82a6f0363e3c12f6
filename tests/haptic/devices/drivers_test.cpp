// The HID drivers, threads and all, on a fake device behind a drop-in libhidapi-hidraw. Nothing here asserts
// a time: things are waited for, with a deadline far beyond any machine's load, and recognised by counters.
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "haptic/devices/emergency_zero.h"
#include "haptic/devices/enumerate.h"
#include "haptic/devices/hid/hid_port.h"
#include "haptic/devices/hid/space_mouse.h"
#include "haptic/devices/wooden/wooden_haptics.h"
#include "haptic/devices/wooden/wooden_kinematics.h"
#include "tests/haptic/devices/fake_hidapi/fake_woody.h"
#include "tests/haptic/devices/fake_hidapi/wire.h"
#include "tests/support/eventually.h"
#include "tests/support/temp_folder.h"

namespace fettle::haptic {
namespace {

using namespace std::chrono_literals;
using fake::FakeWoody;
using Firmware = FakeWoody::Firmware;
using Clock = std::chrono::steady_clock;

// A loop on a thread of its own, 1 kHz: reads, writes the force that was set, and notes what it saw.
class Loop {
 public:
  explicit Loop(Device& device) : device_(device), thread_([this] { run(); }) {}
  ~Loop() { stop(); }
  void stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  enum class Writes { kYes, kNo };
  void setForce(const glm::dvec3& f) {
    const std::lock_guard lock(mutex_);
    force_ = f;
  }
  void setWrites(Writes writes) { writes_ = writes == Writes::kYes; }
  [[nodiscard]] DeviceInput input() const {
    const std::lock_guard lock(mutex_);
    return input_;
  }
  [[nodiscard]] std::uint64_t ticks() const { return ticks_; }
  [[nodiscard]] std::int64_t worstCallNs() const { return worst_; }

 private:
  void run() {
    Clock::time_point next = Clock::now();
    std::uint64_t last = 0;
    while (!stop_) {
      glm::dvec3 force;
      {
        const std::lock_guard lock(mutex_);
        force = force_;
      }
      const auto before = Clock::now();
      const DeviceInput in = device_.read();
      if (writes_) device_.write(force);
      worst_ = std::max<std::int64_t>(worst_, (Clock::now() - before).count());
      EXPECT_GE(in.sequence, last);
      EXPECT_TRUE(std::isfinite(in.position_mm.x + in.position_mm.y + in.position_mm.z));
      last = in.sequence;
      {
        const std::lock_guard lock(mutex_);
        input_ = in;
      }
      ++ticks_;
      next += 1ms;
      std::this_thread::sleep_until(next);
    }
  }

  Device& device_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> writes_{true};
  std::atomic<std::uint64_t> ticks_{0};
  std::atomic<std::int64_t> worst_{0};
  mutable std::mutex mutex_;
  DeviceInput input_;
  glm::dvec3 force_{0.0};
  std::thread thread_;
};

class Drivers : public testing::Test {
 protected:
  Drivers() { ::setenv(fake::kFolderVariable, folder_.path().c_str(), 1); }

  [[nodiscard]] std::string folder() const { return folder_.path().string(); }
  static std::unique_ptr<WoodenHaptics> driver(const std::string& which = {}) {
    return std::make_unique<WoodenHaptics>(*wooden("woody_v2015"),
                                           std::make_unique<HidSource>(HidKind::kWoodenHaptics, which));
  }

 private:
  tests::TempFolder folder_;
};

bool connected(const Loop& loop) {
  return loop.input().link == LinkState::kConnected;
}

bool uncalibrated(const Loop& loop) {
  return loop.input().link == LinkState::kUncalibrated && loop.input().sequence > 0;
}

// One bench of device, driver and loop, calibrated in the home pose.
struct Bench {
  Bench(const std::string& folder, Firmware firmware)
      : firmware_(firmware),
        woody(folder, "woody", firmware),
        device(std::make_unique<WoodenHaptics>(*wooden("woody_v2015"),
                                               std::make_unique<HidSource>(HidKind::kWoodenHaptics))),
        loop(nullptr) {
    woody.plug();
    started = device->start().has_value();
    loop = std::make_unique<Loop>(*device);
  }
  ~Bench() {
    loop->stop();
    device->stop();
  }
  [[nodiscard]] bool calibrate() {
    if (!fettle::tests::eventually([&] { return uncalibrated(*loop); })) return false;
    if (firmware_ == Firmware::kP14)
      woody.pressCalibration();
    else
      device->calibrate();
    return fettle::tests::eventually([&] { return connected(*loop); });
  }
  Firmware firmware_;
  FakeWoody woody;
  std::unique_ptr<WoodenHaptics> device;
  std::unique_ptr<Loop> loop;
  bool started = false;
};

class EachFirmware : public Drivers, public testing::WithParamInterface<Firmware> {};
INSTANTIATE_TEST_SUITE_P(Firmware, EachFirmware, testing::Values(Firmware::kW8, Firmware::kP14),
                         [](const auto& firmware) { return firmware.param == Firmware::kW8 ? "W8" : "P14"; });

const glm::dvec3 kHomeDesk{0.0, -25.0, 205.0};  // (0.025, 0, 0.205) m with x towards the user

TEST_P(EachFirmware, HomePoseIsReadAfterCalibrationAndMotionIsFollowed) {
  Bench bench(folder(), GetParam());
  ASSERT_TRUE(bench.started);
  ASSERT_TRUE(bench.calibrate());
  EXPECT_TRUE(fettle::tests::eventually(
      [&] { return glm::length(bench.loop->input().position_mm - kHomeDesk) < 1e-9; }));
  bench.woody.turnTo({100, -200, 300});
  const WoodenConfig c = *wooden("woody_v2015");
  const glm::dvec3 expected = 1000.0 * woodenToDesk(woodenPosition(c, woodenAngles(c, {100, -200, 6300})));
  EXPECT_TRUE(fettle::tests::eventually(
      [&] { return glm::length(bench.loop->input().position_mm - expected) < 1e-9; }));
}

TEST_P(EachFirmware, ForceBecomesTheCurrentsOfItsPose) {
  Bench bench(folder(), GetParam());
  ASSERT_TRUE(bench.calibrate());
  const WoodenConfig c = *wooden("woody_v2015");
  const glm::dvec3 angles = woodenAngles(c, {0, 0, 6000});
  const glm::dvec3 force{0.5, -0.3, 1.0};
  const glm::dvec3 ma = woodenCurrents(c, woodenTorques(c, angles, deskToWooden(force)));
  const std::uint64_t odd = bench.woody.log().odd_outputs;  // a wake-up of P14's size, before W8 was known
  bench.loop->setForce(force);
  const std::array<std::int16_t, 3> expected{static_cast<std::int16_t>(std::lround(ma.x)),
                                             static_cast<std::int16_t>(std::lround(ma.y)),
                                             static_cast<std::int16_t>(std::lround(ma.z))};
  EXPECT_TRUE(fettle::tests::eventually([&] { return bench.woody.log().ma == expected; }));
  EXPECT_EQ(bench.woody.log().odd_outputs, odd);
}

TEST_P(EachFirmware, NoForceReachesAnUncalibratedDevice) {
  Bench bench(folder(), GetParam());
  bench.loop->setForce({2, 2, 2});
  ASSERT_TRUE(
      fettle::tests::eventually([&] { return uncalibrated(*bench.loop) && bench.woody.log().outputs > 20; }));
  EXPECT_EQ(bench.woody.log().most_ma, 0);
}

TEST_P(EachFirmware, ForceFarOverTheMotorsLimitIsScaledNotClipped) {
  Bench bench(folder(), GetParam());
  ASSERT_TRUE(bench.calibrate());
  bench.loop->setForce({30, -20, 100});
  const WoodenConfig c = *wooden("woody_v2015");
  const glm::dvec3 ma =
      woodenCurrents(c, woodenTorques(c, woodenAngles(c, {0, 0, 6000}), deskToWooden({30, -20, 100})));
  ASSERT_TRUE(fettle::tests::eventually([&] { return bench.woody.log().most_ma >= 2999; }));
  const fake::WoodyLog log = bench.woody.log();
  EXPECT_LE(log.most_ma, 3000);
  // Same direction: each current is the same share of what was asked for, but for rounding to 1 mA.
  const double scale = glm::length(glm::dvec3{log.ma[0], log.ma[1], log.ma[2]}) / glm::length(ma);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(log.ma[static_cast<std::size_t>(i)], scale * ma[i], 1.0);
  EXPECT_GT(bench.device->counters().scaled_forces, 0U);
}

TEST_P(EachFirmware, UnplugAndReplugGoThroughDisconnectedToUncalibratedWithoutForce) {
  Bench bench(folder(), GetParam());
  ASSERT_TRUE(bench.calibrate());
  bench.loop->setForce({1, 0, 1});
  ASSERT_TRUE(fettle::tests::eventually([&] { return bench.woody.log().most_ma > 0; }));
  const std::uint64_t before = bench.loop->input().sequence;
  bench.woody.unplug();
  ASSERT_TRUE(
      fettle::tests::eventually([&] { return bench.loop->input().link == LinkState::kDisconnected; }));
  bench.woody.plug();
  ASSERT_TRUE(
      fettle::tests::eventually([&] { return bench.loop->input().link == LinkState::kUncalibrated; }));
  ASSERT_TRUE(fettle::tests::eventually([&] { return bench.loop->input().sequence > before + 50; }));
  EXPECT_EQ(bench.woody.log().most_ma, 0);  // though the loop kept on writing its force
  ASSERT_TRUE(bench.calibrate());
  EXPECT_TRUE(fettle::tests::eventually([&] { return bench.woody.log().most_ma > 0; }));
  EXPECT_EQ(bench.device->counters().disconnects, 1U);
  EXPECT_EQ(bench.device->counters().connects, 2U);
}

TEST_P(EachFirmware, StopSendsAnExplicitZero) {
  Bench bench(folder(), GetParam());
  ASSERT_TRUE(bench.calibrate());
  bench.loop->setForce({0, 0, 1});
  ASSERT_TRUE(fettle::tests::eventually([&] { return bench.woody.log().most_ma > 0; }));
  bench.loop->stop();
  bench.device->stop();
  EXPECT_EQ(bench.woody.log().ma, (std::array<std::int16_t, 3>{}));  // at once, on return
  EXPECT_EQ(bench.woody.log().watchdog_fired, 0U);
}

TEST_P(EachFirmware, ForceOfALoopThatFallsSilentIsTakenBack) {
  Bench bench(folder(), GetParam());
  ASSERT_TRUE(bench.calibrate());
  bench.loop->setForce({0, 0, 1});
  ASSERT_TRUE(fettle::tests::eventually([&] { return bench.woody.log().most_ma > 0; }));
  bench.loop->setWrites(Loop::Writes::kNo);
  EXPECT_TRUE(
      fettle::tests::eventually([&] { return bench.woody.log().ma == std::array<std::int16_t, 3>{}; }));
  EXPECT_EQ(bench.woody.log().watchdog_fired, 0U);
  // The device has a report before the thread that wrote it comes back to count it.
  EXPECT_TRUE(fettle::tests::eventually([&] { return bench.device->counters().forced_zeros > 0; }));
  // And the device is kept awake: it never sees 500 ms without an output.
  const std::uint64_t outputs = bench.woody.log().outputs;
  EXPECT_TRUE(fettle::tests::eventually([&] { return bench.woody.log().outputs > outputs + 5; }));
}

TEST_P(EachFirmware, ShortOversizedAndGarbageReportsAreCountedAndLeftOut) {
  Bench bench(folder(), GetParam());
  ASSERT_TRUE(bench.calibrate());
  for (int i = 0; i < 10; ++i) {
    bench.woody.sendRaw({1});
    bench.woody.sendRaw({1, 2, 3, 4, 5});
    bench.woody.sendRaw(std::vector<std::uint8_t>(200, 0x77));
    bench.woody.sendRaw(std::vector<std::uint8_t>(64, 0xFF));
  }
  EXPECT_TRUE(fettle::tests::eventually([&] { return bench.device->counters().bad_inputs >= 40; }));
  EXPECT_EQ(bench.device->counters().bad_inputs, 40U);
  const std::uint64_t now = bench.loop->input().sequence;
  EXPECT_TRUE(fettle::tests::eventually([&] { return bench.loop->input().sequence > now + 20; }));
  EXPECT_LT(glm::length(bench.loop->input().position_mm - kHomeDesk), 1e-9);
}

TEST_P(EachFirmware, PausesOfTwentyMillisecondsLeaveTheLinkUp) {
  Bench bench(folder(), GetParam());
  ASSERT_TRUE(bench.calibrate());
  for (int i = 0; i < 5; ++i) {
    bench.woody.pause(20ms);
    std::this_thread::sleep_for(30ms);
    const std::uint64_t now = bench.loop->input().sequence;
    EXPECT_TRUE(fettle::tests::eventually([&] { return bench.loop->input().sequence > now + 10; }));
  }
  EXPECT_TRUE(connected(*bench.loop));
  EXPECT_EQ(bench.device->counters().disconnects, 0U);
}

TEST_F(Drivers, StalledOutNeitherStopsInputsNorHoldsTheLoop) {
  Bench bench(folder(), Firmware::kW8);
  ASSERT_TRUE(bench.calibrate());
  bench.loop->setForce({0, 0, 0.5});
  ASSERT_TRUE(fettle::tests::eventually([&] { return bench.woody.log().most_ma > 0; }));
  bench.woody.stallOut(true);
  // One write at most was under way; from then on the writer hangs, and nothing else does.
  std::this_thread::sleep_for(20ms);
  const std::uint64_t outputs = bench.woody.log().outputs;
  const std::uint64_t inputs = bench.loop->input().sequence;
  const std::uint64_t ticks = bench.loop->ticks();
  ASSERT_TRUE(fettle::tests::eventually([&] { return bench.loop->input().sequence > inputs + 300; }));
  EXPECT_GT(bench.loop->ticks(), ticks + 100);
  EXPECT_EQ(bench.woody.log().outputs, outputs);
  RecordProperty("worst_loop_call_ns", std::to_string(bench.loop->worstCallNs()));
  bench.woody.stallOut(false);
  EXPECT_TRUE(fettle::tests::eventually([&] { return bench.woody.log().outputs > outputs + 100; }));
  EXPECT_GT(bench.device->counters().longest_output_ns, 100'000'000);
}

TEST_F(Drivers, UnplugWhileOutIsStalledIsSurvived) {
  Bench bench(folder(), Firmware::kW8);
  ASSERT_TRUE(bench.calibrate());
  bench.woody.stallOut(true);
  std::this_thread::sleep_for(20ms);
  bench.woody.unplug();
  ASSERT_TRUE(
      fettle::tests::eventually([&] { return bench.loop->input().link == LinkState::kDisconnected; }));
  bench.woody.stallOut(false);
  bench.woody.plug();
  ASSERT_TRUE(bench.calibrate());
  const std::uint64_t outputs = bench.woody.log().outputs;
  EXPECT_TRUE(fettle::tests::eventually([&] { return bench.woody.log().outputs > outputs + 20; }));
}

TEST_F(Drivers, LockStepDeviceGetsOneReplyForEachInput) {
  Bench bench(folder(), Firmware::kP14);
  ASSERT_TRUE(bench.calibrate());
  ASSERT_TRUE(fettle::tests::eventually([&] { return bench.loop->input().sequence > 500; }));
  const fake::WoodyLog log = bench.woody.log();
  // Each input was sent after the reply to the one before; what else went out are zeros of silence: at the
  // start, and when this machine held a thread up for more than 10 ms.
  EXPECT_LE(log.inputs, log.outputs + 1);
  // The device has a report before the thread that wrote it comes back to count it.
  EXPECT_TRUE(fettle::tests::eventually(
      [&] { return log.outputs <= log.inputs + bench.device->counters().forced_zeros; }));
  EXPECT_EQ(log.watchdog_fired, 0U);
}

TEST_F(Drivers, StylusButtonOfP14IsThePrimaryOne) {
  Bench bench(folder(), Firmware::kP14);
  ASSERT_TRUE(bench.calibrate());
  bench.woody.pressStylus(true);
  EXPECT_TRUE(fettle::tests::eventually([&] { return bench.loop->input().buttons == kPrimaryButton; }));
  bench.woody.pressStylus(false);
  EXPECT_TRUE(fettle::tests::eventually([&] { return bench.loop->input().buttons == 0; }));
}

TEST_F(Drivers, DeviceThatComesLaterIsPickedUp) {
  auto device = driver();
  ASSERT_TRUE(device->start());
  {
    Loop loop(*device);
    EXPECT_TRUE(fettle::tests::eventually([&] { return loop.ticks() > 20; }));
    EXPECT_EQ(loop.input().link, LinkState::kDisconnected);
    FakeWoody woody(folder(), "woody", Firmware::kW8);
    woody.plug();
    EXPECT_TRUE(fettle::tests::eventually([&] { return uncalibrated(loop); }));
  }
  device->stop();
}

TEST_F(Drivers, DriverStartsAgainAfterStop) {
  Bench bench(folder(), Firmware::kW8);
  ASSERT_TRUE(bench.calibrate());
  for (int i = 0; i < 3; ++i) {
    bench.loop->stop();
    bench.device->stop();
    ASSERT_TRUE(bench.device->start());
    bench.loop = std::make_unique<Loop>(*bench.device);
    ASSERT_TRUE(bench.calibrate());
  }
}

std::ptrdiff_t openFiles() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
}

TEST_F(Drivers, AStoppedDriverLeavesNoDeviceOpen) {
  FakeWoody woody(folder(), "woody", Firmware::kW8);
  woody.plug();
  ASSERT_TRUE(fettle::tests::eventually([] { return listDevices().size() == 1; }));
  auto device = driver();
  const std::ptrdiff_t before = openFiles();
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(device->start());
    {
      Loop loop(*device);
      EXPECT_TRUE(fettle::tests::eventually([&] { return uncalibrated(loop); }));
      EXPECT_GT(openFiles(), before);
    }
    device->stop();
  }
  // The device, which is in this process, hears a moment later that nobody is there any more.
  EXPECT_TRUE(fettle::tests::eventually([&] { return openFiles() <= before; })) << openFiles() - before;
}

// Older firmware counts nothing: its reports have the number 0.
TEST_F(Drivers, AReportWithoutANumberIsNoLoss) {
  Bench bench(folder(), Firmware::kW8);
  ASSERT_TRUE(bench.calibrate());
  const std::uint64_t before = bench.device->counters().lost_inputs;
  const std::uint64_t seen = bench.loop->input().sequence;
  bench.woody.sendRaw(std::vector<std::uint8_t>(8, 0));
  ASSERT_TRUE(fettle::tests::eventually([&] { return bench.loop->input().sequence > seen + 20; }));
  // At most those that the next number says were there before it: not the 65,000 up to a number that begins again.
  EXPECT_LE(bench.device->counters().lost_inputs - before, bench.woody.log().inputs);
}

TEST_F(Drivers, TwoDevicesAreDistinguishedBySerialNumber) {
  FakeWoody left(folder(), "left", Firmware::kW8, "L1");
  FakeWoody right(folder(), "right", Firmware::kW8, "R2");
  left.plug();
  right.plug();
  ASSERT_TRUE(fettle::tests::eventually([] { return listDevices().size() == 2; }));
  const std::vector<DeviceInfo> found = listDevices();
  EXPECT_EQ(found[0].serial, "L1");
  EXPECT_EQ(found[1].serial, "R2");
  for (const DeviceInfo& d : found) {
    EXPECT_EQ(d.kind, DeviceKind::kWoodenHaptics);
    EXPECT_TRUE(d.gives_force);
    EXPECT_TRUE(d.readable);
    EXPECT_EQ(d.usage_page, 0xFFAB);
    EXPECT_EQ(d.name, "WoodenHaptics");  // without a maker, on no bus, with interface -1
  }
  const auto named = openDevice("woodenhaptics:R2"), first = openDevice("woodenhaptics");
  ASSERT_TRUE(named && first);
  EXPECT_EQ((*named)->profile().serial, "R2");
  EXPECT_EQ((*first)->profile().serial, "L1");
  auto device = driver("R2");
  ASSERT_TRUE(device->start());
  Loop loop(*device);
  EXPECT_TRUE(fettle::tests::eventually([&] { return uncalibrated(loop) && right.log().inputs > 0; }));
  EXPECT_EQ(left.log().outputs, 0U);
  loop.stop();
  device->stop();
}

TEST_F(Drivers, ZeroOfADyingProgramGoesStraightToTheDevice) {
  Bench bench(folder(), Firmware::kW8);
  ASSERT_TRUE(bench.calibrate());
  bench.loop->setForce({0, 0, 1});
  ASSERT_TRUE(fettle::tests::eventually([&] { return bench.woody.log().most_ma > 0; }));
  EXPECT_EQ(zeroAllDevices(), 1);
  EXPECT_TRUE(fettle::tests::eventually([&] { return bench.woody.log().direct_zeros == 1; }));
  bench.loop->stop();
  bench.device->stop();
  EXPECT_EQ(zeroAllDevices(), 0);  // nothing is held any more
}

TEST_F(Drivers, NamesOfDevicesKeepTheirLetters) {
  fake::Description description;
  description.manufacturer = "Müller & Søn";
  description.product_name = "Stift 5\u00b5m \u20ac \uac00 \U0001d11e";
  description.serial = "\ufffd1";
  fake::FakeHid hid(folder(), "named", description);
  hid.plug();
  const std::vector<HidInterface> found = hidInterfaces();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].manufacturer, description.manufacturer);
  EXPECT_EQ(found[0].product_name, description.product_name);
  EXPECT_EQ(found[0].serial, description.serial);
}

// A SpaceMouse on a thread of its own, repeating its reports while deflected, as the real ones do.
class FakeSpaceMouse {
 public:
  explicit FakeSpaceMouse(const std::string& folder)
      : hid_(folder, "mouse", {0x256f, 0xc635, 1, 8, 0, "3Dconnexion", "SpaceMouse Compact", ""}),
        thread_([this] { run(); }) {}
  ~FakeSpaceMouse() {
    stop_ = true;
    thread_.join();
  }
  void report(const std::vector<std::vector<std::uint8_t>>& reports) {
    const std::lock_guard lock(mutex_);
    reports_ = reports;
  }

 private:
  void run() {
    hid_.plug();
    while (!stop_) {
      hid_.serve(8, fake::FakeHid::Out::kTaken, [](auto) {});
      const std::lock_guard lock(mutex_);
      for (const auto& r : reports_) hid_.send(r);
    }
  }
  fake::FakeHid hid_;
  std::mutex mutex_;
  std::vector<std::vector<std::uint8_t>> reports_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

TEST_F(Drivers, SpaceMouseMovesTheTipInBothFormsAndRestsWhenReleased) {
  FakeSpaceMouse fake(folder());
  SpaceMouse mouse(std::make_unique<HidSource>(HidKind::kSpaceMouse));
  ASSERT_TRUE(mouse.start());
  Loop loop(mouse);
  ASSERT_TRUE(fettle::tests::eventually([&] { return connected(loop); }));
  EXPECT_EQ(loop.input().position_mm, glm::dvec3{0.0});
  fake.report({{1, 100, 0, 0, 0, 0, 0}});  // right
  ASSERT_TRUE(fettle::tests::eventually([&] { return loop.input().position_mm.x > 1.0; }));
  // Towards the user and down: y and z fall.
  fake.report({{1, 0, 0, 100, 0, 100, 0, 0, 0, 0, 0, 0, 0}, {3, 1, 0}});
  ASSERT_TRUE(fettle::tests::eventually(
      [&] { return loop.input().position_mm.y < -1.0 && loop.input().position_mm.z < -1.0; }));
  EXPECT_EQ(loop.input().buttons, kPrimaryButton);
  fake.report({{1, 0, 0, 0, 0, 0, 0}});
  glm::dvec3 last{1e9};
  EXPECT_TRUE(fettle::tests::eventually([&] {
    const glm::dvec3 now = loop.input().position_mm;
    const bool still = now == last;
    last = now;
    std::this_thread::sleep_for(20ms);
    return still;
  }));
  loop.stop();
  mouse.stop();
  const std::vector<DeviceInfo> found = listDevices();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].kind, DeviceKind::kSpaceMouse);
  EXPECT_EQ(found[0].name, "3Dconnexion SpaceMouse Compact");
  EXPECT_FALSE(found[0].gives_force);
}

}  // namespace
}  // namespace fettle::haptic
