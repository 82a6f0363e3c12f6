#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::app {

/// A long job on its own thread, polled by the main thread once per frame. Starting another cancels the
/// running one and waits until it stops (JobControl: about 50 ms); so does the destructor. Threading: the
/// main thread calls everything.
template <class T>
class Background {
 public:
  using Work = std::function<engine::Result<T>(engine::JobControl&)>;

  ~Background() { cancel(); }
  Background& operator=(Background&&) = delete;

  void start(Work work) {
    cancel();
    thread_ = {};
    run_ = std::make_unique<Run>();
    thread_ = std::jthread([run = run_.get(), work = std::move(work)] {
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

  void cancel() noexcept {
    if (run_) run_->job.cancel();
  }

  [[nodiscard]] bool busy() const noexcept { return run_ != nullptr; }
  /// 0 .. 1; and the name of the stage.
  [[nodiscard]] double progress() const noexcept {
    if (!run_ || run_->job.total() == 0) return 0.0;
    return std::min(1.0, static_cast<double>(run_->job.done()) / static_cast<double>(run_->job.total()));
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
    std::optional<engine::Result<T>> result;
    std::atomic<bool> done{false};
  };
  std::unique_ptr<Run> run_;
  std::jthread thread_;  // last: joined before the data it uses is destroyed
};

}  // namespace fettle::app
