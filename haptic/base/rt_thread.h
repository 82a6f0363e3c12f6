#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace fettle::haptic {

/// What a real-time thread requests from the system.
struct RealTimeRequest {
  int core = -1;                         ///< core to stay on; -1 = the last of those the process may use
  int priority = 80;                     ///< SCHED_FIFO priority, 1 .. 99; 0 = normal scheduling
  bool lock_memory = true;               ///< pages stay in memory once touched (whole process)
  bool hold_latency = true;              ///< keep the processor out of deep sleep (/dev/cpu_dma_latency)
  std::size_t stack_bytes = 256 * 1024;  ///< of its stack, touched beforehand
};

/// What the system granted.
struct RealTimeReport {
  int core = -1;  ///< pinned to; -1 = not pinned
  int priority = 0;
  bool memory_locked = false;
  bool latency_held = false;
  /// One sentence for each request that was not granted: what, why, and how to allow it. Empty: all granted.
  std::vector<std::string> missing;
};

/// Makes the calling thread a real-time one for the life of the object: pinned, SCHED_FIFO, pages locked on
/// fault, stack touched, processor kept awake. What the system does not allow is reported, and the thread
/// runs on without it. The destructor restores the previous state.
///
/// mlockall(MCL_FUTURE) is only asked for when the limit of locked memory is infinite or does not apply: with
/// a finite one the first allocation beyond it would fail, wherever in the program that is.
///
/// Threading: constructed and destroyed on the thread it is about, outside its ticks (allocates, calls the
/// system).
class RealTimeScope {
 public:
  explicit RealTimeScope(const RealTimeRequest& request);
  ~RealTimeScope();
  RealTimeScope& operator=(RealTimeScope&&) = delete;

  [[nodiscard]] const RealTimeReport& report() const noexcept { return report_; }

 private:
  void pin(int core);
  void schedule(int priority);
  void lockMemory();
  void holdLatency();

  struct Before;
  std::unique_ptr<Before> before_;
  RealTimeReport report_;
};

/// Flushes denormal floats to zero on the calling thread while it lives (FTZ and DAZ on x86, FZ on ARM;
/// nothing elsewhere): one denormal operand can cost 150 cycles. Code whose results must be bit-identical to
/// the loop's uses the same scope.
class DenormalScope {
 public:
  DenormalScope() noexcept;
  ~DenormalScope();
  DenormalScope& operator=(DenormalScope&&) = delete;

 private:
  unsigned long before_ = 0;
};

}  // namespace fettle::haptic
