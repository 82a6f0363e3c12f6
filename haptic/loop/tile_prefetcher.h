#pragma once

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include "engine/field/live_field.h"
#include "engine/field/version.h"
#include "haptic/base/rings.h"
#include "haptic/loop/messages.h"

namespace fettle::haptic {

/// A state from which the loop continues; the number identifies it, 0 is none.
struct FollowedState {
  engine::Version live, original;
  std::uint32_t number = 0;
};

/// Keeps the tiles around the stylus in memory while the field lies in a store (engine/field/tile_store.h),
/// so that the loop never waits for the disk: its own thread prefetches the tiles around the stylus, locks
/// their pages, and unlocks those left behind. Where the hand is faster than the disk, ready() returns false,
/// and no surface is felt in that tick.
///
/// Prefetched are the tiles of the state from which the loop continued and of the original. Tiles that
/// strokes wrote since lie in ordinary memory anyway. The prefetcher holds the state meanwhile, so that the
/// loop is never the only holder of a stored tile and never writes in place on a mapped page: it copies.
///
///   loop                                           prefetch thread
///   replaced(), ready()     --- ring of states -->  prefetch(): reads and locks the tiles around `requested`
///   ready(): sets requested --- one word -------->            that are new, publishes `available`, and one
///            reads available <-- one word ---------            round later unlocks the others
///
/// Threading: replaced() and ready() on the loop's thread, wait-free, nothing allocated or freed; prefetch() on
/// the prefetch thread, or in a test; construction, start() and destruction on the main side.
class TilePrefetcher {
 public:
  /// Tiles prefetched on each side of that of the stylus: 9 x 9, 1.6 MB per state. The loop needs kMargin
  /// samples around tip and proxy, which leaves 100 samples of lead.
  static constexpr int kTiles = 4;
  static constexpr int kMargin = engine::kTileSide + 24;

  TilePrefetcher();
  ~TilePrefetcher();
  TilePrefetcher& operator=(TilePrefetcher&&) = delete;

  /// Starts the thread. Once; throws std::system_error as std::thread does.
  void start();

  /// Loop: the field or the original was replaced. Nothing is ready until its tiles have been prefetched.
  void replaced() noexcept {
    ++state_;
    announced_ = false;
  }

  /// Loop: whether every tile of the field and the original under the samples may be read now. `rect` lies in
  /// the field and is not empty; `column`, `row`: the sample around which to prefetch from now on.
  [[nodiscard]] bool ready(const engine::LiveField& field, const engine::Version& original,
                           const engine::SampleRect& rect, std::int32_t column, std::int32_t row) noexcept;

  /// Prefetch thread: one round. May wait for the disk.
  void prefetch() noexcept;

  /// Any thread: tiles prefetched so far; those whose pages could not be locked and were only read
  /// (RLIMIT_MEMLOCK).
  [[nodiscard]] std::uint64_t prefetched() const noexcept {
    return prefetched_.load(std::memory_order_relaxed);
  }
  [[nodiscard]] std::uint64_t notLocked() const noexcept {
    return not_locked_.load(std::memory_order_relaxed);
  }

 private:
  // A tile's column, its row and the number of the state, in one word. Sides have at most 4096 tiles.
  struct Place {
    std::uint16_t column = 0, row = 0;
    std::uint32_t state = 0;
    friend bool operator==(const Place&, const Place&) = default;
  };
  static_assert(std::atomic<Place>::is_always_lock_free);
  void collect(const engine::Version& version, const Place& around) noexcept;

  // Used by the loop only.
  std::uint32_t state_ = 0;
  bool announced_ = true;  // whether state_ was sent to the prefetch thread

  SpscRing<FollowedState> followed_{8};
  std::atomic<Place> requested_{Place{}};
  std::atomic<Place> available_{Place{}};

  // Used by the prefetch thread only.
  FollowedState held_;
  std::vector<const engine::Tile*> locked_, next_, outdated_;

  std::atomic<std::uint64_t> prefetched_{0}, not_locked_{0};  // relaxed: for display
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace fettle::haptic
