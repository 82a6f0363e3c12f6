#pragma once

#include <cstddef>
#include <memory>

#include "engine/base/error.h"

namespace fettle::haptic {

/// The last words of a program that is being ended: zero to every device that gives force. The drivers of
/// this room are covered by zeroAllDevices() (devices/emergency_zero.h); whoever gives force by another way
/// registers a function that works in a signal handler.
///
/// Covered: SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT (the program's own fault), SIGTERM, SIGINT, SIGHUP,
/// SIGQUIT (asked to end), and exit(). After the zeros the signal takes the way it had before install(): the
/// earlier handler is called or the default action ends the program, core dump included. What was ignored
/// stays ignored, without zeros.
///
/// NOT covered: SIGKILL, the out-of-memory killer and power loss. No program can answer these; what stops the
/// force then is the device's own watchdog (WoodenHaptics: 500 ms by HID, 100 ms by USB serial).
class LastResort {
 public:
  /// What a device registers: an async-signal-safe function (one non-blocking write() of a ready report;
  /// no lock, no allocation), and what it works on. May run on any thread, at any time while registered, and
  /// more than once.
  using ZeroReport = void (*)(void* device) noexcept;

  /// Installs the handlers; call it after the program's own. Calling it again puts handlers that others
  /// replaced since back in front. Errors: kFailed when the system refuses. Thread: main.
  [[nodiscard]] static engine::Status install();

  /// Whether the zeros were sent: from then on no force may be given (the loop asks each tick). Any thread,
  /// wait-free, relaxed: the loop sees it at the latest a tick later.
  [[nodiscard]] static bool fired() noexcept;

  /// Sends all zeros and sets fired(). Async-signal-safe, any thread; what the handlers call.
  static void fire() noexcept;

  /// Forgets that it fired: for a program that lives on after SIGINT, and for tests. Thread: main.
  static void reset() noexcept;
};

/// A registration for as long as it lives. The destructor returns when no handler is using it any more.
/// At most kMost at a time; `registered()` is false for one too many.
class ZeroOnLastResort {
 public:
  static constexpr int kMost = 16;

  ZeroOnLastResort(LastResort::ZeroReport report, void* device) noexcept;
  ~ZeroOnLastResort();
  ZeroOnLastResort(const ZeroOnLastResort&) = delete;
  ZeroOnLastResort& operator=(const ZeroOnLastResort&) = delete;

  [[nodiscard]] bool registered() const noexcept { return slot_ >= 0; }

 private:
  int slot_ = -1;
};

/// A stack of its own for signal handlers of the calling thread, so that a stack overflow still says zero.
/// Constructed and destroyed on that thread; allocates 64 KiB.
class HandlerStack {
 public:
  HandlerStack();
  ~HandlerStack();
  HandlerStack(const HandlerStack&) = delete;
  HandlerStack& operator=(const HandlerStack&) = delete;

 private:
  static constexpr std::size_t kBytes = 65536;
  std::unique_ptr<std::byte[]> memory_;
};

}  // namespace fettle::haptic
