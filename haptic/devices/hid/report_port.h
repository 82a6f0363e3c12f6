#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

namespace fettle::haptic {

enum class PortRead : std::uint8_t {
  kReport,   ///< one whole report arrived
  kTimeout,  ///< none in time
  kGone,     ///< the device is unplugged; the port cannot be used any more
};

struct ReadOutcome {
  PortRead kind = PortRead::kTimeout;
  std::size_t size = 0;  ///< bytes of the report; a longer one than the buffer is cut
};

enum class PortWrite : std::uint8_t {
  kDone,
  kFailed,  ///< this report was not accepted (a stalled device); a later one may be
  kGone,    ///< unplugged
};

/// One end of a connection that carries whole reports (HID reports without report id, or text lines).
/// Threading: one thread at a time; both calls may wait.
class ReportPort {
 public:
  virtual ~ReportPort() = default;
  ReportPort& operator=(ReportPort&&) = delete;

  /// Waits for one report up to `timeout`; 0 = only one that has already arrived.
  [[nodiscard]] virtual ReadOutcome read(std::span<std::uint8_t> buffer,
                                         std::chrono::milliseconds timeout) noexcept = 0;
  /// May block for 5 s on a device that stopped accepting reports.
  [[nodiscard]] virtual PortWrite write(std::span<const std::uint8_t> report) noexcept = 0;
};

/// An opened device: two ports, since its reader and its writer are two threads and neither may wait for the
/// other.
struct OpenedPorts {
  std::unique_ptr<ReportPort> reading;
  std::unique_ptr<ReportPort> writing;  ///< null for devices without output
  std::size_t input_bytes = 0;          ///< of an input report as the device describes itself; 0 = not known
};

/// Finds and opens a device; called repeatedly, which is how hot plugging works.
class ReportSource {
 public:
  virtual ~ReportSource() = default;
  ReportSource& operator=(ReportSource&&) = delete;

  /// Nothing when no such device is plugged in or it cannot be opened. Takes some milliseconds. One thread.
  [[nodiscard]] virtual std::optional<OpenedPorts> open() noexcept = 0;
};

}  // namespace fettle::haptic
