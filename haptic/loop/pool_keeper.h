#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <thread>

#include "engine/field/node_pool.h"

namespace fettle::haptic {

/// Keeps the tiles and nodes that the loop takes in store: a thread of its own looks every few milliseconds
/// and grows the pools when they are low, with their pages already in memory. The loop never asks, wakes or
/// waits.
///
/// Threading: constructed and destroyed on the main side; grown() from any thread.
class PoolKeeper {
 public:
  struct Levels {
    /// Free tiles below which more are made. The largest brush takes 16 a publication, 2,000 a second: half a
    /// second's worth. 17 MB.
    std::size_t tiles = 1024;
    std::size_t nodes = 256;
    std::int64_t look_every_ns = 2'000'000;
  };

  /// Fills up to the levels before it returns, then keeps watch.
  PoolKeeper(std::shared_ptr<engine::FieldMemory> memory, const Levels& levels);
  ~PoolKeeper();
  PoolKeeper(const PoolKeeper&) = delete;
  PoolKeeper& operator=(const PoolKeeper&) = delete;

  /// Times the pools were grown; times memory was not to be had.
  [[nodiscard]] std::uint64_t grown() const noexcept { return grown_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t failed() const noexcept { return failed_.load(std::memory_order_relaxed); }

 private:
  void topUp() noexcept;

  std::shared_ptr<engine::FieldMemory> memory_;
  Levels levels_;
  // Relaxed all: counters for show, and a stop that may be seen one look late.
  std::atomic<std::uint64_t> grown_{0};
  std::atomic<std::uint64_t> failed_{0};
  std::atomic<bool> stop_{false};
  std::thread thread_;  // last: starts when all else is there
};

}  // namespace fettle::haptic
