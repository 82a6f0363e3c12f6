#pragma once

#include <semaphore.h>

#include <cstdint>
#include <ctime>

#include "engine/base/stopwatch.h"

namespace fettle::haptic {

/// One thread waits, others wake it: several wake-ups before it looks are one. Threading: post() from any thread, also a servo thread: it
/// never waits; waitFor() from one thread.
class WakeUp {
 public:
  WakeUp() { sem_init(&posted_, 0, 0); }
  ~WakeUp() { sem_destroy(&posted_); }
  WakeUp& operator=(WakeUp&&) = delete;

  /// Increments a counter and, where the thread sleeps, makes one futex call. It fails only where the counter is full, and then the thread
  /// is awake anyway.
  void post() noexcept { sem_post(&posted_); }

  /// Returns at once where it was woken since the last call, and after `longest_ns` at the latest.
  void waitFor(std::int64_t longest_ns) noexcept {
    constexpr std::int64_t kSecond = 1'000'000'000;
    // steady_clock is CLOCK_MONOTONIC, which changes of the wall clock do not affect.
    const std::int64_t until = engine::steadyNs() + longest_ns;
    const timespec at{.tv_sec = until / kSecond, .tv_nsec = until % kSecond};
    if (sem_clockwait(&posted_, CLOCK_MONOTONIC, &at) != 0) return;
    while (sem_trywait(&posted_) == 0) {
    }
  }

 private:
  sem_t posted_{};
};

}  // namespace fettle::haptic
