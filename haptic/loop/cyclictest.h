#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

#include "engine/base/error.h"
#include "haptic/loop/timing.h"

namespace fettle::haptic {

/// The kernel developers' own measure of wake-up lateness (package rt-tests), as a child process: one thread
/// on one core that does nothing but absolute sleeps. It holds /dev/cpu_dma_latency itself, as the haptic
/// loop does. Threading: one thread.
class Cyclictest {
 public:
  struct Settings {
    int core = 0;
    int priority = 80;  ///< SCHED_FIFO; 0 = normal
    double rate_hz = 1000.0;
    double seconds = 1.0;
  };

  /// Whether the program is on the PATH.
  [[nodiscard]] static bool installed();

  /// Starts it. Errors (kFailed): no process can be started.
  [[nodiscard]] static engine::Result<Cyclictest> start(const Settings& settings);
  Cyclictest(Cyclictest&& other) noexcept;
  Cyclictest& operator=(Cyclictest&&) = delete;
  ~Cyclictest();  ///< ends it

  /// Waits for its end and adds what it measured to `lateness` (whole microseconds). Errors (kFailed): it
  /// refused, with its own message - for example without the right to SCHED_FIFO.
  [[nodiscard]] engine::Status finish(TimingHistogram& lateness);

 private:
  Cyclictest(pid_t child, int output) noexcept : child_(child), output_(output) {}

  pid_t child_;
  int output_;
};

/// Adds a histogram as cyclictest prints it (-h): lines "microseconds count", comments with '#', of which
/// "Max Latencies" and "Histogram Overflows" describe what lay beyond the last class: it is added as the
/// maximum, never too low. False when there is no such histogram in the text.
[[nodiscard]] bool addCyclictestHistogram(const std::string& text, TimingHistogram& lateness);

/// Child processes that each keep a processor busy at normal priority, with more memory than the caches hold,
/// until the object is destroyed. They end with their parent in every case.
class BusyProcesses {
 public:
  /// Fewer than requested when the system refuses; see size().
  explicit BusyProcesses(unsigned number);
  ~BusyProcesses();
  BusyProcesses& operator=(BusyProcesses&&) = delete;

  [[nodiscard]] std::size_t size() const noexcept { return children_.size(); }

 private:
  std::vector<pid_t> children_;
};

}  // namespace fettle::haptic
