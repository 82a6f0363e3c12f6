#pragma once

#include <cstddef>
#include <memory>

#include "engine/base/error.h"

namespace fettle::haptic {

/// Sends zero force to every force device when the program is ended. Devices with a driver are covered by
/// zeroAllDevices() (devices/emergency_zero.h); other code that applies force registers a function that is
/// safe in a signal handler.
///
/// Covered: SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT (the program's own fault), SIGTERM, SIGINT, SIGHUP,
/// SIGQUIT (requests to end), and exit(). After the zeros the signal is handled as before install(): the
/// earlier handler is called or the default action ends the program, core dump included. An ignored signal
/// stays ignored, without zeros.
///
/// NOT covered: SIGKILL, the out-of-memory killer and power loss. No program can handle these; then the
/// device's own watchdog stops the force (WoodenHaptics: 500 ms by HID, 100 ms by USB serial).
class LastResort {
 public:
  /// What a device registers: an async-signal-safe function (one non-blocking write() of a ready report;
  /// no lock, no allocation), and what it works on. May run on any thread, at any time while registered, and
  /// more than once.
  using ZeroReport = void (*)(void* device) noexcept;

  /// Installs the handlers; call it after the program's own. Calling it again reinstalls handlers that were
  /// replaced since. Errors: kFailed when the system refuses. Thread: main.
  [[nodiscard]] static engine::Status install();

  /// Whether the zeros were sent: from then on no force may be applied (the loop checks in each tick). Any
  /// thread, wait-free, relaxed: the loop sees it at the latest a tick later.
  [[nodiscard]] static bool fired() noexcept;

  /// Sends all zeros and sets fired(). Async-signal-safe, any thread; what the handlers call.
  static void fire() noexcept;

  /// Clears fired(): for a program that continues after SIGINT, and for tests. Thread: main.
  static void reset() noexcept;
};

/// A registration for the lifetime of the object. The destructor returns when no handler uses it any more. At
/// most kMost at a time; `registered()` is false beyond that.
class ZeroOnLastResort {
 public:
  static constexpr int kMost = 16;

  ZeroOnLastResort(LastResort::ZeroReport report, void* device) noexcept;
  ~ZeroOnLastResort();
  ZeroOnLastResort& operator=(ZeroOnLastResort&&) = delete;

  [[nodiscard]] bool registered() const noexcept { return slot_ >= 0; }

 private:
  int slot_ = -1;
};

/// A separate stack for signal handlers of the calling thread, so that zeros are sent even after a stack
/// overflow. Constructed and destroyed on that thread; allocates 64 KiB.
class HandlerStack {
 public:
  HandlerStack();
  ~HandlerStack();
  HandlerStack& operator=(HandlerStack&&) = delete;

 private:
  static constexpr std::size_t kBytes = 65536;
  std::unique_ptr<std::byte[]> memory_;
};

}  // namespace fettle::haptic
