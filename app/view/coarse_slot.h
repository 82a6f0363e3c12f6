#pragma once

#include <mutex>
#include <optional>
#include <utility>

#include "engine/io/preview.h"

namespace fettle::app {

/// Brings the coarse picture of a scan from the thread that goes on to read the rest to the window.
/// Threading: any; a lock is held for a move.
class CoarseSlot {
 public:
  void put(engine::Preview preview) {
    const std::scoped_lock lock(mutex_);
    preview_ = std::move(preview);
  }
  /// What was put since the last call.
  [[nodiscard]] std::optional<engine::Preview> take() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(preview_, std::nullopt);
  }

 private:
  std::mutex mutex_;
  std::optional<engine::Preview> preview_;  // guarded by mutex_
};

}  // namespace fettle::app
