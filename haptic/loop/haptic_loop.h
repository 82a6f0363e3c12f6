#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <thread>

#include "engine/base/error.h"
#include "haptic/base/rt_thread.h"
#include "haptic/loop/loop_tick.h"
#include "haptic/loop/pool_keeper.h"
#include "haptic/loop/tile_prefetcher.h"
#include "haptic/loop/timing.h"

namespace fettle::haptic {

/// The live loop: its own thread, which owns the live version and runs one LoopTick per period.
///
/// Life: construct, start(), any number of send() and poll(), stop(); once only.
/// Threading: one main thread calls everything; timing() may be read by any. send(), poll() and state() never
/// wait.
class HapticLoop {
 public:
  struct Settings {
    LoopOptions options;
    double rate_hz = 1000.0;  ///< 1000 .. 10000
    RealTimeRequest real_time;
    PoolKeeper::Levels pool;
    std::shared_ptr<SoundRing> sounds;  ///< see PreparedScene
  };

  /// Works on `start` (upright) according to `scene`; `original` is what Scene::max_change is measured
  /// against, often `start` itself. The device is started and stopped by the caller, and outlives the loop.
  /// Errors (kInput): a scene, limits, a rate or ring capacities out of range, grids that differ.
  [[nodiscard]] static engine::Result<std::unique_ptr<HapticLoop>> create(const engine::Version& start,
                                                                          const engine::Version& original,
                                                                          const Scene& scene, Device& device,
                                                                          const Settings& settings);
  ~HapticLoop();
  HapticLoop& operator=(HapticLoop&&) = delete;

  /// Fills the pools, starts the thread and returns when it is about to tick. Errors: kFailed when no thread
  /// can be started. What the system did not grant the thread is no error: see realTime().
  [[nodiscard]] engine::Status start();

  /// Ends the thread after a last tick with zero force. The field as it was left, the sign as felt; events
  /// still in the ring can be polled afterwards.
  engine::Version stop();

  /// False when the ring of commands is full; `command` is then untouched.
  [[nodiscard]] bool send(LoopCommand&& command) noexcept {
    return channels_.commands.push(std::move(command));
  }
  /// LoopChannels::disarm(): immediately, before all queued commands, never refused.
  void disarm() noexcept { channels_.disarm(); }
  /// LoopChannels::armCommand(), to be sent.
  [[nodiscard]] LoopCommand armCommand() const noexcept { return channels_.armCommand(); }
  /// The oldest event that was not polled yet; false when there is none.
  [[nodiscard]] bool poll(LoopEvent& event) noexcept { return channels_.events.pop(event); }
  /// The oldest record of a tick that was not taken yet (LoopOptions::record_capacity); false when there is
  /// none. The rest can be taken after stop().
  [[nodiscard]] bool pollRecord(TickRecord& record) noexcept { return channels_.records.pop(record); }
  /// The newest tick; valid until the next call: copy it if it is needed longer.
  [[nodiscard]] const LoopState& state() noexcept {
    channels_.state.take();
    return channels_.state.latest();
  }

  [[nodiscard]] const LoopTiming& timing() const noexcept { return timing_; }
  /// What the system granted the thread; empty before start().
  [[nodiscard]] const RealTimeReport& realTime() const noexcept { return real_time_; }
  /// Keeps the samples around the stylus in memory; null for a field that lies in memory anyway.
  [[nodiscard]] const TilePrefetcher* tilePrefetcher() const noexcept { return tile_prefetcher_.get(); }
  /// Times the loop's thread waited for the disk so far (major page faults; read every 1024 ticks and at the
  /// end). Any thread.
  [[nodiscard]] std::uint64_t diskWaits() const noexcept {
    return disk_waits_.load(std::memory_order_relaxed);
  }

 private:
  HapticLoop(const engine::Version& start, std::unique_ptr<PreparedScene> scene, Device& device,
             const Settings& settings);
  void main() noexcept;

  Settings settings_;
  std::shared_ptr<engine::FieldMemory> memory_;
  LoopChannels channels_;
  std::unique_ptr<TilePrefetcher> tile_prefetcher_;
  LoopTick tick_;
  LoopTiming timing_;
  RealTimeReport real_time_;
  std::optional<PoolKeeper> keeper_;
  std::atomic<std::uint64_t> disk_waits_{0};  // relaxed: for display
  std::atomic<bool> ready_{false};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace fettle::haptic
