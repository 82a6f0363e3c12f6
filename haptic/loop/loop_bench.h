#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "haptic/loop/timing.h"

namespace fettle::haptic {

/// What else keeps the machine busy while the loop is measured.
enum class BenchLoad : std::uint8_t {
  kIdle,  ///< nothing of ours
  kBusy,  ///< on every core a thread at normal priority that works through memory without a pause
};

struct LoopBenchOptions {
  double seconds = 60.0;    ///< in all, > 0 .. 3600
  double rate_hz = 1000.0;  ///< 1000 .. 10000
  BenchLoad load = BenchLoad::kIdle;
  int priority = 80;  ///< SCHED_FIFO of both threads; 0 = normal
};

/// One thread's time keeping.
struct LoopBenchRow {
  std::string name;  ///< "haptic loop", "plain thread"
  TimingFigures lateness;
  TimingFigures compute;             ///< of the plain thread: count 0
  std::uint64_t missed = 0;          ///< periods skipped
  std::uint64_t over_1_ms = 0;       ///< wake-ups later than 1 ms
  std::vector<std::string> missing;  ///< what the system did not give (RealTimeReport)
};

struct LoopBenchReport {
  double seconds = 0.0;  ///< measured
  double rate_hz = 0.0;
  BenchLoad load = BenchLoad::kIdle;
  std::string machine;  ///< processor and number of cores
  LoopBenchRow loop;
  LoopBenchRow plain;
  double p99_ratio = 0.0;   ///< loop over plain; 0 when the plain one is 0
  double p999_ratio = 0.0;  ///< likewise. Target: at most 1.2
  std::uint64_t refused_edits = 0;
  std::uint64_t events = 0;  ///< publications that the main side took
};

/// Measures the live loop beside a thread that does nothing but cyclictest's part (absolute sleep, pinned,
/// same priority, memory locked). Both run at the same time on different cores, so that they meet the same
/// weather, and change cores halfway, so that a core with more interrupts favours neither; on one core they
/// run one after the other. The loop does all it does in a session: a simulated hand presses and smooths a
/// 1024 x 1024 field for good, the main side takes the edits.
///
/// Progress: stage "measuring", steps = milliseconds. Errors: kInput for options out of range; kCancelled;
/// kFailed when threads or memory cannot be had. Thread: main; blocks.
[[nodiscard]] engine::Result<LoopBenchReport> benchLoop(const LoopBenchOptions& options,
                                                        engine::JobControl& job);

}  // namespace fettle::haptic
