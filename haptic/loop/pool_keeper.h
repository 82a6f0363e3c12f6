#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <thread>

#include "engine/field/node_pool.h"

namespace fettle::haptic {

/// Keeps enough free tiles and nodes for the loop: its own thread checks every few milliseconds and grows the
/// pools when they are low, with their pages already in memory. The loop never requests, wakes or waits.
///
/// Threading: constructed and destroyed on the main side; grown() from any thread.
class PoolKeeper {
 public:
  struct Levels {
    /// Free tiles below which more are made. The largest brush takes 16 per publication, 4,000 per second:
    /// enough for half a second. 35 MB.
    std::size_t tiles = 2048;
    std::size_t nodes = 256;
    std::int64_t poll_interval_ns = 2'000'000;
  };

  /// Fills the pools to the levels before it returns, then monitors them.
  PoolKeeper(std::shared_ptr<engine::FieldMemory> memory, const Levels& levels);
  ~PoolKeeper();
  PoolKeeper& operator=(PoolKeeper&&) = delete;

  /// Times the pools were grown; times no memory was available.
  [[nodiscard]] std::uint64_t grown() const noexcept { return grown_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t failed() const noexcept { return failed_.load(std::memory_order_relaxed); }

 private:
  void topUp() noexcept;

  std::shared_ptr<engine::FieldMemory> memory_;
  Levels levels_;
  // All relaxed: counters for display, and a stop that may be seen one check late.
  std::atomic<std::uint64_t> grown_{0};
  std::atomic<std::uint64_t> failed_{0};
  std::atomic<bool> stop_{false};
  std::thread thread_;  // last: starts when all other members exist
};

}  // namespace fettle::haptic
