#pragma once

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "app/terminal.h"
#include "app/work/behind_the_window.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/base/stopwatch.h"

namespace fettle::app {

/// How far a job is.
struct WorkProgress {
  double share = 0.0;          ///< 0 .. 1, of the present stage
  std::optional<double> left;  ///< how long the stage still takes [s], where that is known (RemainingTime)
};

/// A long job on its own thread, polled by the main thread once per frame. Starting another cancels the
/// running one and waits until it stops (JobControl: about 50 ms of the processor); so does the destructor. Threading: the
/// main thread calls everything; the work goes behind it (behind_the_window.h).
template <class T>
class Background {
 public:
  using Work = std::function<engine::Result<T>(engine::JobControl&)>;

  ~Background() { cancel(); }
  Background& operator=(Background&&) = delete;

  void start(Work work) {
    cancel();
    thread_ = {};
    begin(std::move(work));
  }

  /// The same without waiting: the running one ends beside the new one, and its result is dropped. Only where work uses
  /// nothing but what it was given.
  void replace(Work work) {
    cancel();
    std::erase_if(left_, [](const Left& left) { return left.run->done.load(std::memory_order_acquire); });
    if (run_) left_.push_back({std::move(run_), std::move(thread_)});
    begin(std::move(work));
  }

  void cancel() noexcept {
    if (run_) run_->job.cancel();
  }

  [[nodiscard]] bool busy() const noexcept { return run_ != nullptr; }
  /// Of the present stage; and its name.
  [[nodiscard]] WorkProgress progress() const {
    if (!run_ || run_->job.total() == 0) return {};
    const engine::JobControl& job = run_->job;
    const double share = std::min(1.0, static_cast<double>(job.done()) / static_cast<double>(job.total()));
    return {share, job.cancelled() ? std::nullopt : run_->remaining.at(run_->begun.seconds(), job, nullptr)};
  }
  [[nodiscard]] const char* stage() const noexcept { return run_ ? run_->job.stage() : ""; }
  [[nodiscard]] bool cancelling() const noexcept { return run_ && run_->job.cancelled(); }

  /// Waits for the result: for shutdown. Empty when no work is running.
  [[nodiscard]] std::optional<engine::Result<T>> wait() {
    if (!run_) return std::nullopt;
    thread_.join();
    std::optional<engine::Result<T>> result = std::move(run_->result);
    run_.reset();
    return result;
  }

  /// The result, once, when it is available.
  [[nodiscard]] std::optional<engine::Result<T>> take() {
    // Acquire: pairs with the release above.
    if (!run_ || !run_->done.load(std::memory_order_acquire)) return std::nullopt;
    return wait();
  }

 private:
  struct Run {
    engine::JobControl job;
    engine::Stopwatch begun;
    RemainingTime remaining;  // of the main thread, as progress()
    std::optional<engine::Result<T>> result;
    std::atomic<bool> done{false};
  };
  struct Left {
    std::unique_ptr<Run> run;
    std::jthread thread;
  };

  void begin(Work work) {
    run_ = std::make_unique<Run>();
    thread_ = std::jthread([run = run_.get(), work = std::move(work)] {
      goBehindTheWindow();
      try {
        run->result.emplace(work(run->job));
      } catch (const std::bad_alloc&) {
        run->result.emplace(
            engine::failure("memory ran out", "", "close other programs or take a smaller scan"));
      }
      // Release: publishes the result.
      run->done.store(true, std::memory_order_release);
    });
  }

  std::vector<Left> left_;  // cancelled, ending
  std::unique_ptr<Run> run_;
  std::jthread thread_;  // last: joined before the data it uses is destroyed
};

}  // namespace fettle::app
