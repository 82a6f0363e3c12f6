#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::app {

/// For its lifetime, Ctrl-C (SIGINT), SIGTERM and SIGHUP cancel the job instead of ending the process; a
/// second one ends it immediately, as by default. One object at a time in a process.
class InterruptGuard {
 public:
  explicit InterruptGuard(engine::JobControl& job);
  ~InterruptGuard();
  InterruptGuard& operator=(InterruptGuard&&) = delete;
};

/// Progress of a command with many files. Threading: as JobControl.
struct BatchState {
  std::atomic<std::size_t> done{0};  ///< files finished, failed ones included
  std::size_t count = 0;             ///< not changed while a ProgressLine exists; >= 1
};

/// "40 s", "12 min", "3.5 h".
[[nodiscard]] std::string durationText(double seconds);

/// How long work will still take, from how fast it went so far: that of the present stage, of a batch that of all
/// files that are left. Threading: one thread.
class RemainingTime {
 public:
  /// `seconds`: the time now, since any fixed moment, never less than in the call before. Nothing in the first seconds
  /// of a stage, before a hundredth of it is done, and in a batch before its first file is finished.
  [[nodiscard]] std::optional<double> at(double seconds, const engine::JobControl& job,
                                         const BatchState* batch);

 private:
  const char* stage_ = nullptr;
  std::uint64_t done_ = 0;
  std::uint64_t from_ = 0;  // what was done of the stage when it was first seen
  double begun_ = 0.0;      // then
  double first_ = -1.0;     // call
  std::size_t files_ = 0;   // finished at the last call
  double last_file_ = 0.0;  // when the last one was
};

/// Text of the progress line: the job's stage, its bar, its share, and how long [s] it still takes where that is known;
/// with a batch the bar and the time count files, and stage and share are those of the current file.
[[nodiscard]] std::string progressText(const engine::JobControl& job, const BatchState* batch,
                                       std::optional<double> left = std::nullopt);

/// For its lifetime, shows the job's progress as one line on stderr - but only when stderr is a terminal, and
/// only after the job has run for a second. The line is erased at the end.
class ProgressLine {
 public:
  explicit ProgressLine(const engine::JobControl& job, const BatchState* batch = nullptr);
  ~ProgressLine();
  ProgressLine& operator=(ProgressLine&&) = delete;

 private:
  void show();

  const engine::JobControl& job_;
  const BatchState* batch_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool ended_ = false;  // guarded by mutex_
  std::thread thread_;
};

/// What the program writes to stderr. Set once, before a command runs.
struct Voice {
  bool quiet = false;  ///< errors only: no warnings, no progress line
  bool json = false;   ///< errors as JSON objects; warnings are collected for the report
};
void setVoice(const Voice& voice);
[[nodiscard]] const Voice& voice() noexcept;

/// For its lifetime, what this thread would write to stderr is kept here instead, and no progress line is shown: for a
/// program that calls commands (python/), and for trials that would say the same again and again. Of several the last one made counts,
/// which is destroyed first. Threading: the thread that made it.
class KeptMessages {
 public:
  KeptMessages();
  ~KeptMessages();
  KeptMessages& operator=(KeptMessages&&) = delete;

  std::vector<std::string> warnings;  ///< of warn(), in their order

 private:
  KeptMessages* before_;
};

/// Prints "fettle: error: what, where, remedy" on stderr and returns the exit status that belongs to it:
/// 2 for bad usage or input, 1 for everything else. With Voice::json one line with one object: `schema`, `error` (the
/// line without its head), `kind` (input, failed, cancelled), `what`, `where`, `remedy`, `status`,
/// `warnings`.
int report(const engine::Error& error);

/// Prints "fettle: warning: ..." on stderr; with Voice::json collects it. Threading: any.
void warn(const std::string& text);

/// Prints "fettle: ..." on stderr, neither with Voice::quiet nor with Voice::json, nor where messages are kept. Threading:
/// any.
void note(const std::string& text);

/// The warnings kept so far, which are kept no more.
[[nodiscard]] std::vector<std::string> takeWarnings();

}  // namespace fettle::app
