#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "haptic/loop/ratio_interval.h"
#include "haptic/loop/timing.h"

namespace fettle::haptic {

/// Load on the machine while the loop is measured.
enum class BenchLoad : std::uint8_t {
  kIdle,  ///< no added load
  kBusy,  ///< as many processes as cores, at normal priority, that work through memory without a pause
};

struct LoopBenchOptions {
  double seconds = 60.0;    ///< in all, > 0 .. 3600
  double rate_hz = 1000.0;  ///< 1000 .. 10000
  BenchLoad load = BenchLoad::kIdle;
  int priority = 80;  ///< SCHED_FIFO of both threads; 0 = normal
  /// A device as `--device` names it, driven by the loop instead of the simulated hand; nobody arms, so it is given zero
  /// forces only. Empty: the simulated hand.
  std::string device{};
};

/// Timing of one thread.
struct LoopBenchRow {
  std::string name;  ///< "haptic loop", "cyclictest", "plain thread"
  TimingFigures lateness;
  TimingFigures compute;             ///< of the loop alone; of others: count 0
  std::uint64_t missed = 0;          ///< periods skipped; cyclictest does not count them
  std::uint64_t over_1_ms = 0;       ///< wake-ups later than 1 ms
  std::vector<std::string> missing;  ///< what the system did not grant (RealTimeReport)
  bool latency_held = false;         ///< /dev/cpu_dma_latency
};

struct LoopBenchReport {
  double seconds = 0.0;  ///< measured
  double rate_hz = 0.0;
  BenchLoad load = BenchLoad::kIdle;
  std::string machine;  ///< processor and number of cores
  LoopBenchRow loop;
  LoopBenchRow reference;     ///< cyclictest, or the plain thread where there is none
  std::string no_cyclictest;  ///< why not; empty when it is the reference
  double p99_ratio = 0.0;     ///< loop over reference; 0 when that is 0
  double p999_ratio = 0.0;    ///< likewise. Target: at most 1.2
  /// Of both ratios, from the differences between rounds of two slices; nothing for less than a minute.
  std::optional<RatioIntervals> within;
  std::uint64_t refused_edits = 0;
  std::uint64_t events = 0;         ///< publications that the main side took
  std::uint64_t device_inputs = 0;  ///< of options.device: reports that arrived
};

/// Measures the live loop together with cyclictest, or where that is not installed with a plain thread in its
/// place (absolute sleep, pinned, same priority, memory locked). Both run at the same time on different
/// cores, so that conditions are equal, in slices of some seconds, and change cores from slice to slice, so
/// that a core with more interrupts favours neither; on one core they take the slices in turns. The loop does
/// all it does in a session: a simulated hand presses and smooths a 1024 x 1024 field throughout, the main
/// thread takes the edits. With a device of options.device the loop drives that one, its driver's threads and all.
///
/// Progress: stage "measuring", steps = milliseconds. Errors: kInput for options out of range, and as openDevice();
/// kCancelled; kFailed when threads or memory are not available, or nothing came from the device. Thread: main; blocks.
[[nodiscard]] engine::Result<LoopBenchReport> benchLoop(const LoopBenchOptions& options,
                                                        engine::JobControl& job);

}  // namespace fettle::haptic
