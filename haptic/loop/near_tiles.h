#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#include "engine/field/live_field.h"
#include "engine/field/version.h"
#include "haptic/base/rings.h"
#include "haptic/loop/messages.h"

namespace fettle::haptic {

/// What the loop goes on from; the number tells states apart, 0 is none.
struct FollowedState {
  engine::Version live, original;
  std::uint32_t number = 0;
};

/// Keeps the tiles around the hand in memory while the field lies in a store (engine/field/tile_store.h), so
/// that the loop never waits for the disk: a thread of its own reads the tiles around the stylus and locks
/// their pages, ahead of the hand, and lets go of those behind it. Where the hand is quicker than the disk
/// the loop asks ready(), gets false, and feels no surface for that tick.
///
/// What is kept are the tiles of the state that the loop goes on from and of the original. What strokes wrote
/// since lies in ordinary memory anyway. The state is held meanwhile, so that the loop never finds itself the
/// only holder of a stored tile and writes in place on a mapped page: it copies.
///
///   loop                                        keeper
///   replaced(), ready()  --- ring of states -->  bring(): reads and locks what is new around wanted,
///   ready(): wanted      --- one word ------->            says so in near, one look later unlocks
///            reads near  <-- one word --------            what is behind
///
/// Threading: replaced() and ready() on the loop's thread, wait-free, nothing allocated or freed; bring() on
/// the keeper's, or a test's; construction, start() and destruction on the main side.
class NearTiles {
 public:
  /// Tiles on each side of the stylus' own that are kept: 9 x 9, 1.6 MB a state. The loop asks for
  /// kTouch samples around tip and proxy, so a hand has 100 samples of lead.
  static constexpr int kTiles = 4;
  static constexpr int kTouch = engine::kTileSide + 24;

  NearTiles();
  ~NearTiles();
  NearTiles(const NearTiles&) = delete;
  NearTiles& operator=(const NearTiles&) = delete;

  /// Starts the keeper's thread. Once; throws std::system_error as std::thread does.
  void start();

  /// Loop: the field or the original is another from now on. Nothing is ready until its tiles have been
  /// brought.
  void replaced() noexcept {
    ++state_;
    told_ = false;
  }

  /// Loop: whether every tile of the field and the original under the samples may be read now. `rect` lies in
  /// the field and is not empty; `column`, `row`: the sample to keep tiles around from now on.
  [[nodiscard]] bool ready(const engine::LiveField& field, const engine::Version& original,
                           const engine::SampleRect& rect, std::int32_t column, std::int32_t row) noexcept;

  /// Keeper: one look. May wait for the disk.
  void bring() noexcept;

  /// Any thread: tiles brought so far; those whose pages could not be
  /// locked and were only read (RLIMIT_MEMLOCK).
  [[nodiscard]] std::uint64_t brought() const noexcept { return brought_.load(std::memory_order_relaxed); }
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

  // Loop's own.
  std::uint32_t state_ = 0;
  bool told_ = true;  // of this state, the keeper

  SpscRing<FollowedState> followed_{8};
  std::atomic<Place> wanted_{Place{}};
  std::atomic<Place> near_{Place{}};

  // Keeper's own.
  FollowedState held_;
  std::vector<const engine::Tile*> locked_, next_, behind_;

  std::atomic<std::uint64_t> brought_{0}, not_locked_{0};  // relaxed: for show
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace fettle::haptic
