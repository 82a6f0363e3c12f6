#pragma once

#include <semaphore.h>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <thread>

#include <glm/vec3.hpp>

#include "engine/base/error.h"
#include "haptic/base/latest_slot.h"
#include "haptic/devices/device.h"
#include "haptic/devices/hid/output_rule.h"
#include "haptic/devices/hid/report_port.h"

namespace fettle::haptic {

/// How a driver handles its device's reports; called by the threads of a ReportLink.
class ReportHandler {
 public:
  virtual ~ReportHandler() = default;
  ReportHandler& operator=(ReportHandler&&) = delete;

  /// Reader thread: the device was opened; `input_bytes` as in OpenedPorts. Returns when it accepts output,
  /// as far as that is known yet (see onCaughtUp).
  virtual Pacing onOpen(std::size_t input_bytes) noexcept = 0;
  /// Reader thread: one report. False when it is not one of this device's: it is counted and ignored.
  virtual bool onReport(std::span<const std::uint8_t> report, std::int64_t arrival_ns) noexcept = 0;
  /// Reader thread: all reports received so far were handled, `inputs` good ones since start(); update what
  /// the loop reads. Returns the pacing, which may have become known.
  virtual Pacing onCaughtUp(std::uint64_t inputs) noexcept = 0;
  /// Reader thread: the device was unplugged, or the link stops.
  virtual void onLost() noexcept = 0;
  /// Writer thread: one output report; `currents` is what the loop wrote, or zero. Returns its length; 0 =
  /// nothing can be sent.
  virtual std::size_t encode(const glm::dvec3& output, std::span<std::uint8_t> report) noexcept = 0;
};

/// The threads between a loop that must never wait and a device that may block: a reader thread (wait at most
/// 5 ms, then drain to the newest report) and a writer thread (a write may block for 5 s on hidraw when the
/// device stops taking reports). The loop uses neither: it writes to a LatestSlot and reads from the slot
/// that the handler publishes to.
///
///     device --report--> reader thread --handler--> [slot] --> loop --> [slot] --> writer thread --> device
///                             `------- count of inputs, wake-up -------------------^
///
/// Two ports for one device: hidapi's read and write both replace the error text of their handle, so one
/// handle shared by two threads is a data race with a double free (hidapi 0.13, register_device_error).
class ReportLink {
 public:
  ReportLink(std::unique_ptr<ReportSource> source, ReportHandler& handler, const OutputTimes& times = {});
  ~ReportLink();
  ReportLink& operator=(ReportLink&&) = delete;

  [[nodiscard]] engine::Status start();
  /// See Device::stop().
  void stop() noexcept;

  /// Loop thread, wait-free: output for the device (motor currents, whatever encode() takes).
  void write(const glm::dvec3& output) noexcept;

  /// Any thread, wait-free: since when a write has been waiting for the device [engine::steadyNs]; 0 = none is.
  [[nodiscard]] std::int64_t writingSinceNs() const noexcept {
    // Relaxed: independent of other data, read once per tick.
    return writing_since_ns_.load(std::memory_order_relaxed);
  }

  /// Loop thread, wait-free: whether the newest output has not been sent, so that the device still applies an
  /// older one.
  [[nodiscard]] bool outputPending() const noexcept {
    // Relaxed: independent of other data; seeing it late delays a rise by one tick.
    return published_ns_ != sent_ns_.load(std::memory_order_relaxed);
  }

  /// Any thread. Each counter is exact; together they may be of slightly different times.
  [[nodiscard]] DeviceCounters counters() const noexcept;

 private:
  struct Output {
    glm::dvec3 value{0.0};
    std::int64_t written_ns = 0;
  };

  void runReader() noexcept;
  void runWriter() noexcept;
  enum class Ended : std::uint8_t { kGone, kStopping };
  [[nodiscard]] Ended readWhileConnected(ReportPort& port) noexcept;
  void passToWriter(std::unique_ptr<ReportPort> port, Pacing pacing) noexcept;
  void setPacing(Pacing pacing) noexcept;
  [[nodiscard]] bool waitForPlug() noexcept;
  void waitForWork(std::int64_t until_ns) noexcept;
  [[nodiscard]] PortWrite send(ReportPort& port, OutputRule::Send what, const glm::dvec3& value) noexcept;

  std::unique_ptr<ReportSource> source_;
  ReportHandler& handler_;
  OutputTimes times_;
  LatestSlot<Output> output_;
  std::int64_t published_ns_ = 0;         // loop thread's own: Output::written_ns of the newest output
  std::atomic<std::int64_t> sent_ns_{0};  // the same of the output that was sent last
  sem_t work_{};  // posted by the loop (new force) and by the reader (new input, new port, stop)
  std::thread reader_;
  std::thread writer_;

  // Reader to writer, not the loop: a lock is allowed.
  std::mutex mutex_;
  std::condition_variable stopped_;
  bool stopping_ = false;
  std::unique_ptr<ReportPort> new_port_;
  bool replace_port_ = false;  // by new_port_, which may be null
  Pacing pacing_ = Pacing::kNone;
  std::uint64_t inputs_at_open_ = 0;
  std::uint64_t generation_ = 0;  // incremented with each change of port or pacing

  // Counters: relaxed throughout, each is independent. The writer also reads `inputs_` to see that an input
  // needs an answer; if it sees the value late, the semaphore, whose post follows the increment, synchronises
  // with its wait.
  std::atomic<std::uint64_t> inputs_{0};
  std::atomic<std::uint64_t> skipped_{0};
  std::atomic<std::uint64_t> bad_inputs_{0};
  std::atomic<std::uint64_t> outputs_{0};
  std::atomic<std::uint64_t> forced_zeros_{0};
  std::atomic<std::uint64_t> failed_outputs_{0};
  std::atomic<std::uint64_t> connects_{0};
  std::atomic<std::uint64_t> disconnects_{0};
  std::atomic<std::int64_t> longest_output_ns_{0};
  std::atomic<std::int64_t> writing_since_ns_{0};
};

}  // namespace fettle::haptic
