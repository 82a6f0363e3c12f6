#pragma once

#include <optional>

#include <termios.h>

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

}  // namespace fettle::app
