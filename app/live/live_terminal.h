#pragma once

#include <optional>

#include <termios.h>

#include "app/live/session_log.h"
#include "haptic/loop/messages.h"
#include "haptic/loop/timing.h"

namespace fettle::app {

/// Source of single keys.
enum class KeySource : std::uint8_t {
  kTerminal,  ///< standard input if it is a terminal, otherwise none
  kAnyInput,  ///< any standard input: one byte, one key; for scripts and other input aids
};

/// Single keys from standard input, without waiting and without echo. The state of a terminal is restored by
/// the destructor, and on a fatal signal by restoreTerminal(). Threading: one thread; one object at a time in
/// a process.
class Keys {
 public:
  explicit Keys(KeySource source);
  ~Keys();
  Keys& operator=(Keys&&) = delete;

  /// Whether keys can be read.
  [[nodiscard]] bool available() const noexcept { return available_; }
  /// The next key, if one was pressed. Line ends are left out.
  [[nodiscard]] std::optional<char> next() noexcept;

  /// Async-signal-safe; fits LastResort::ZeroReport. No effect when no terminal was changed.
  static void restoreTerminal(void*) noexcept;

 private:
  bool available_ = false;
};

/// Output of a live session: one line on stderr that is updated, when stderr is a terminal, and a line for
/// each event; nothing with Voice::quiet. One thread.
class StatusLine {
 public:
  StatusLine();
  ~StatusLine();  ///< wipes the line
  StatusLine& operator=(StatusLine&&) = delete;

  /// Redraws at most five times per second. `ticks_per_second` as measured.
  void show(const haptic::LoopState& state, const haptic::LoopTiming& timing, double seconds,
            double ticks_per_second);
  void report(const SessionEvent& event);

 private:
  void wipe();

  bool terminal_ = false;
  double shown_at_ = -1.0;
};

}  // namespace fettle::app
