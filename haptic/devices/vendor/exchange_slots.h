#pragma once

#include <semaphore.h>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>

#include <glm/vec3.hpp>

#include "haptic/base/latest_slot.h"
#include "haptic/devices/device.h"
#include "haptic/devices/emergency_zero.h"

namespace fettle::haptic {

/// What the loop and the one thread that talks to a device exchange, for devices that are driven through their
/// maker's library or service: each exchange carries a force out and a pose in, and may block.
///
///     loop --write()--> [slot] --forceToSend()--> link thread <--> library or service
///     loop <--read()--- [slot] <----takeInput()------'
///
/// What leaves through forceToSend() is zero unless the device is connected and calibrated, the loop renewed
/// its force within 10 ms, the link is not stopping and no fatal signal arrived; and it is never longer than
/// the device's own largest force.
///
/// Threading: "loop" and "link" below are one thread each; what says neither is for any thread. Only the calls
/// that say so wait.
class ExchangeSlots {
 public:
  ExchangeSlots();
  ~ExchangeSlots();
  ExchangeSlots& operator=(ExchangeSlots&&) = delete;

  /// Loop, wait-free: see Device.
  [[nodiscard]] DeviceInput read() noexcept;
  void write(const glm::dvec3& force_n) noexcept;

  /// Link: the device is there. `max_force_n`: its own limit; not positive or not finite: no force is sent.
  void opened(LinkState state, double max_force_n) noexcept;
  /// Link: calibrated now, or no longer.
  void setState(LinkState state) noexcept;
  [[nodiscard]] LinkState state() const noexcept { return newest_.link; }
  /// Link: unplugged, or not driven any more.
  void lost() noexcept;

  /// Link, wait-free: the force of the exchange that begins now [N, desk].
  [[nodiscard]] glm::dvec3 forceToSend() noexcept;
  /// Link, wait-free: that force has reached the device, or has not.
  void sent() noexcept;
  void notSent() noexcept;
  /// Link, wait-free: the device was not ready for it; the next exchange carries the newest.
  void deferred() noexcept { exchange_since_.store(0, std::memory_order_relaxed); }
  /// Link, wait-free: a pose arrived. One that is not finite, or farther than any arm reaches, is counted as
  /// bad and left out.
  void takeInput(const glm::dvec3& position_mm, std::uint32_t buttons,
                 const std::optional<glm::dquat>& orientation = std::nullopt) noexcept;
  void badInput() noexcept;
  /// Link, wait-free: the device reported a fault of its own.
  void fault() noexcept;

  /// Link: waits for a new force, for stop, or for `until_ns` [engine::steadyNs].
  void waitForForce(std::int64_t until_ns) noexcept;
  /// Link: waits for stop at most so long; false when stopping.
  [[nodiscard]] bool waitWhileRunning(std::int64_t for_ns) noexcept;
  [[nodiscard]] bool stopping() const noexcept { return stopping_.load(std::memory_order_relaxed); }

  void start() noexcept;
  /// The link has to end; from now on only zeros are sent.
  void requestStop() noexcept;
  /// The link thread has ended; wakes waitEnded(), which returns false when that took longer than `for_ns`.
  void ended() noexcept;
  [[nodiscard]] bool waitEnded(std::int64_t for_ns) noexcept;

  /// The user has done what the device needs for its calibration; taken once by the link.
  void requestCalibration() noexcept { calibration_requested_.store(true, std::memory_order_relaxed); }
  [[nodiscard]] bool takeCalibrationRequest() noexcept {
    return calibration_requested_.exchange(false, std::memory_order_relaxed);
  }

  [[nodiscard]] DeviceCounters counters() const noexcept;

 private:
  struct Output {
    glm::dvec3 force_n{0.0};
    std::int64_t written_ns = 0;
  };

  LatestSlot<DeviceInput> input_;
  LatestSlot<Output> output_;
  sem_t work_{};  // posted by the loop (new force) and by requestStop()
  // Loop's own.
  std::int64_t published_ns_ = 0;  // Output::written_ns of the newest output
  std::int64_t waiting_since_ns_ =
      0;  // when the oldest output that waits was written: a thread that stands, or a call that blocks

  // Link's own.
  DeviceInput newest_;
  double max_force_n_ = 0.0;
  std::int64_t sending_ns_ = 0;  // Output::written_ns of the force of the running exchange
  bool sending_forced_zero_ = false;
  bool sending_zero_ = true;
  ZeroWhenHeld zero_when_held_;

  // Not for the loop: a lock is allowed.
  std::mutex mutex_;
  std::condition_variable changed_;
  bool ended_ = true;

  // All relaxed: each is independent of other data, and seeing it late costs one exchange.
  std::atomic<bool> stopping_{false};
  std::atomic<bool> calibration_requested_{false};
  std::atomic<std::int64_t> sent_ns_{0};         // written_ns of the output that was sent last
  std::atomic<std::int64_t> exchange_since_{0};  // start of the running exchange; 0 = none
  std::atomic<std::uint64_t> inputs_{0};
  std::atomic<std::uint64_t> bad_inputs_{0};
  std::atomic<std::uint64_t> outputs_{0};
  std::atomic<std::uint64_t> forced_zeros_{0};
  std::atomic<std::uint64_t> failed_outputs_{0};
  std::atomic<std::uint64_t> scaled_forces_{0};
  std::atomic<std::uint64_t> faults_{0};
  std::atomic<std::uint64_t> connects_{0};
  std::atomic<std::uint64_t> disconnects_{0};
  std::atomic<std::int64_t> longest_output_ns_{0};
};

}  // namespace fettle::haptic
