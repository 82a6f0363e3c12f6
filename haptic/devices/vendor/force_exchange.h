#pragma once

#include <atomic>
#include <cstdint>

#include <glm/vec3.hpp>

#include "haptic/base/latest_slot.h"
#include "haptic/devices/device.h"
#include "haptic/devices/vendor/wake_up.h"

namespace fettle::haptic {

/// Between the loop, which never waits, and the thread that talks with a maker's library, which may: the library's own servo thread, or
/// one of ours whose calls block. Positions and forces are in the frame of the device's profile (DeviceSpace::kDesk).
///
///     loop --write--> [slot] --force()--> device's thread --received()--> [slot] --read--> loop
///
/// Threading: the loop thread calls read() and write(); of the device's side one thread at a time calls the rest, wait-free but for
/// waitForForce(). counters() from any thread.
class ForceExchange {
 public:
  ForceExchange() = default;
  ForceExchange& operator=(ForceExchange&&) = delete;

  /// As Device::read(). `output_waits_ns` is the time since the oldest force that was not given out: the device's thread stands.
  [[nodiscard]] DeviceInput read() noexcept;
  /// As Device::write().
  void write(const glm::dvec3& force_n) noexcept;

  /// The force to apply now: the newest, or zero where none was written for 10 ms, the device is not connected, or all devices are held at
  /// zero (emergency_zero.h). Finite.
  [[nodiscard]] glm::dvec3 force(std::int64_t now_ns) noexcept;
  /// Whether the library took what force() returned.
  void sent(bool accepted) noexcept;
  /// A pose that the library gave; false where it is none (not finite, or farther than 10 m): it is counted and left out.
  bool received(const glm::dvec3& position_mm, std::uint32_t buttons, std::int64_t now_ns) noexcept;
  void setLink(LinkState link) noexcept;
  /// The library itself reported a fault (motors too warm, a force it refused).
  void fault() noexcept;
  /// Returns when a force was written since the last call, and after `longest_ns` at the latest.
  void waitForForce(std::int64_t longest_ns) noexcept { written_.waitFor(longest_ns); }

  [[nodiscard]] DeviceCounters counters() const noexcept;

 private:
  struct Output {
    glm::dvec3 force_n{0.0};
    std::int64_t written_ns = 0;  // 0: none was
  };

  LatestSlot<DeviceInput> input_;
  LatestSlot<Output> output_;
  WakeUp written_;
  std::int64_t written_ns_ = 0;        // loop's own: of the newest force
  std::int64_t waiting_since_ns_ = 0;  // loop's own: when the oldest force that waits was written
  // Relaxed: a hint; seeing it late delays a rise of the force by one tick.
  std::atomic<std::int64_t> sent_ns_{0};

  // The device's side.
  DeviceInput newest_;
  std::int64_t taken_ns_ = 0;
  bool zero_for_want_ = false;

  // Relaxed throughout: independent counts.
  std::atomic<std::uint64_t> inputs_{0}, bad_inputs_{0}, outputs_{0}, forced_zeros_{0}, failed_outputs_{0},
      faults_{0}, connects_{0}, disconnects_{0};
};

}  // namespace fettle::haptic
