#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tests/haptic/devices/fake_hidapi/fake_hid.h"

namespace fettle::fake {

/// What a fake WoodenHaptics device saw.
struct WoodyLog {
  std::uint64_t inputs = 0;          ///< reports sent
  std::uint64_t outputs = 0;         ///< reports taken
  std::uint64_t odd_outputs = 0;     ///< of a wrong length
  std::uint64_t presets = 0;         ///< P14: command 1
  std::uint64_t watchdog_fired = 0;  ///< 500 ms without output while a current was on
  std::uint64_t direct_zeros = 0;    ///< zero reports written straight to the device file
  std::array<std::int16_t, 3> ma{};  ///< currents now on the motors
  int most_ma = 0;                   ///< largest of any motor since plug() or forgetMost()
};

/// The currents from one moment on, and why they changed.
struct WoodyCurrents {
  enum class By : std::uint8_t {
    kOutput,    ///< an output report
    kDirect,    ///< zeros written straight to the device file
    kWatchdog,  ///< the firmware's own
    kPower,     ///< plugged in or out
  };
  std::chrono::steady_clock::time_point at;
  std::array<std::int16_t, 3> ma{};
  std::array<std::int32_t, 3> counts{};  ///< of the hand then, as turnTo() says them
  By by = By::kOutput;
};

/// A WoodenHaptics device that is not there: firmware W8 (free-running) or P14 (lock-step), 1 kHz, a thread
/// of its own; its watchdog, its encoders that start at zero, its faults on request. All functions: any
/// thread.
class FakeWoody {
 public:
  enum class Firmware : std::uint8_t { kW8, kP14 };

  FakeWoody(std::string folder, std::string name, Firmware firmware, std::string serial = {});
  ~FakeWoody();
  FakeWoody(const FakeWoody&) = delete;
  FakeWoody& operator=(const FakeWoody&) = delete;

  void plug();
  void unplug();
  void stallOut(bool stalled) { stalled_ = stalled; }
  void pause(std::chrono::milliseconds length);
  /// One report of these bytes in between (short, oversized, garbage).
  void sendRaw(std::vector<std::uint8_t> bytes);
  /// What the encoders read, as the firmware counts: from zero at power-on, or from the preset.
  void turnTo(std::array<std::int32_t, 3> counts);
  /// The same, on a straight line of counts that takes so long.
  void moveTo(std::array<std::int32_t, 3> counts, std::chrono::milliseconds length);
  /// Everything that ever set the currents, in order.
  [[nodiscard]] std::vector<WoodyCurrents> history() const;
  void pressStylus(bool pressed) { stylus_ = pressed; }
  void pressCalibration() { latch_ = true; }
  void forgetMost();
  [[nodiscard]] WoodyLog log() const;

 private:
  void run();
  void input();
  void output(std::span<const std::uint8_t> report);
  void move(std::chrono::steady_clock::time_point now);
  void note(WoodyCurrents::By by);

  const Firmware firmware_;
  FakeHid hid_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> stalled_{false};
  std::atomic<bool> stylus_{false};
  std::atomic<bool> latch_{false};
  mutable std::mutex mutex_;
  bool want_plugged_ = false;
  std::chrono::steady_clock::time_point paused_until_;
  std::chrono::steady_clock::time_point last_output_;
  std::vector<std::vector<std::uint8_t>> raw_;
  std::array<std::int32_t, 3> counts_{};
  std::array<std::int32_t, 3> preset_offset_{};
  std::uint16_t counter_ = 0;
  bool waits_for_reply_ = false;
  std::array<std::int32_t, 3> from_{};  // of the motion in progress
  std::array<std::int32_t, 3> to_{};
  std::chrono::steady_clock::time_point from_at_;
  std::chrono::steady_clock::time_point to_at_;
  WoodyLog log_;
  std::vector<WoodyCurrents> history_;
  std::thread thread_;
};

}  // namespace fettle::fake
