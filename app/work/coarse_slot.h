#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <utility>

#include "engine/base/job.h"
#include "engine/io/import.h"

namespace fettle::app {

/// Passes the coarse picture of a scan from the thread that continues to read the rest to the window.
/// Threading: any; a lock is held for a move.
class CoarseSlot {
 public:
  void put(engine::Preview preview) {
    const std::scoped_lock lock(mutex_);
    preview_ = std::move(preview);
  }
  /// The preview put since the last call.
  [[nodiscard]] std::optional<engine::Preview> take() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(preview_, std::nullopt);
  }

  /// The preview was on the screen once, or will not be.
  void shown() {
    {
      const std::scoped_lock lock(mutex_);
      shown_ = true;
    }
    seen_.notify_all();
  }
  /// For the reading thread: waits for shown(), a cancel, or at most this long.
  void waitShown(std::chrono::milliseconds most, const engine::JobControl& job) {
    constexpr std::chrono::milliseconds kPollInterval{10};
    const auto end = std::chrono::steady_clock::now() + most;
    std::unique_lock lock(mutex_);
    while (!shown_ && !job.cancelled() && std::chrono::steady_clock::now() < end)
      seen_.wait_for(lock, kPollInterval, [this] { return shown_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable seen_;
  std::optional<engine::Preview> preview_;  // guarded by mutex_
  bool shown_ = false;                      // guarded by mutex_
};

}  // namespace fettle::app
