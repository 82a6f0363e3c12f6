#pragma once

#include <cstdio>
#include <memory>
#include <string>

#include "app/report.h"
#include "engine/base/error.h"

namespace fettle::app {

/// Reports of the window for a script (`fettle view --events FILE`): one JSON object per line, each written
/// when it differs from the line before, after the frame that shows it.
///
/// Threading: one thread. A slow reader delays the window, a closed one ends the log.
class EventLog {
 public:
  /// Writes nothing.
  EventLog() = default;
  /// Writes to a file, a named pipe or /dev/fd/N. Errors (kInput): it cannot be written to.
  [[nodiscard]] static engine::Result<EventLog> open(const std::string& path);

  [[nodiscard]] bool listens() const noexcept { return file_ != nullptr; }
  /// Writes `state`, followed by `aside`, unless `state` is the same as last time. `aside` is created only
  /// when needed: for values that change all the time, or are expensive to compute.
  void write(Report state, const auto& aside) {
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
