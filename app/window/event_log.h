#pragma once

#include <cstdio>
#include <memory>
#include <string>

#include "app/report.h"
#include "engine/base/error.h"

namespace fettle::app {

/// What the window reports to whoever drives it (`fettle view --events FILE`): one JSON object a line, each
/// written when it differs from the line before. A line is written after the frame that shows what it says.
///
/// Threading: one thread. A reader that is slow delays the window, one that has gone ends the log.
class EventLog {
 public:
  /// Writes nowhere.
  EventLog() = default;
  /// Writes to a file, a named pipe or /dev/fd/N. Errors (kInput): it cannot be written to.
  [[nodiscard]] static engine::Result<EventLog> open(const std::string& path);

  [[nodiscard]] bool listens() const noexcept { return file_ != nullptr; }
  /// Writes `state`, with `aside` after it, unless `state` is the same as last time. `aside` is made only
  /// when needed: what changes all the time, or costs something to find out.
  template <class Aside>
  void write(Report state, const Aside& aside) {
    if (!listens() || state == last_) return;
    last_ = state;
    state.update(aside());
    writeLine(state);
  }

 private:
  struct Closer {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
  };
  void writeLine(const Report& line);

  std::unique_ptr<std::FILE, Closer> file_;
  Report last_;
};

}  // namespace fettle::app
