#pragma once

#include <atomic>
#include <cstdint>

namespace fettle::engine {

/// Progress and cancellation of one long job, shared between the worker that does it and the thread that
/// shows it. The owner keeps it alive until the job has returned.
///
/// Threading: every method may be called from any thread, each is lock-free and never waits. All accesses
/// are relaxed: the numbers are only shown in a progress bar, and seeing cancel() late delays the stop by one
/// step; the join at the end of the job synchronises its result.
class JobControl {
 public:
  JobControl() = default;
  /// A part of `outer`, which outlives it: cancelled with it, but its stages and steps are not those of `outer`.
  [[nodiscard]] static JobControl partOf(const JobControl& outer) noexcept { return JobControl(&outer); }

  /// Starts a stage of `total` steps; steps are whatever the job counts (tiles, rows, bytes).
  /// `name` must be a string literal, e.g. "filtering".
  void begin(const char* name, std::uint64_t total) noexcept {
    stage_.store(name, std::memory_order_relaxed);
    done_.store(0, std::memory_order_relaxed);
    total_.store(total, std::memory_order_relaxed);
  }
  void advance(std::uint64_t steps = 1) noexcept { done_.fetch_add(steps, std::memory_order_relaxed); }

  void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
  [[nodiscard]] bool cancelled() const noexcept {
    return cancelled_.load(std::memory_order_relaxed) || (outer_ != nullptr && outer_->cancelled());
  }

  [[nodiscard]] const char* stage() const noexcept { return stage_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t done() const noexcept { return done_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t total() const noexcept { return total_.load(std::memory_order_relaxed); }

 private:
  explicit JobControl(const JobControl* outer) noexcept : outer_(outer) {}

  const JobControl* const outer_ = nullptr;
  std::atomic<const char*> stage_{""};
  std::atomic<std::uint64_t> done_{0};
  std::atomic<std::uint64_t> total_{0};
  std::atomic<bool> cancelled_{false};
};

}  // namespace fettle::engine
