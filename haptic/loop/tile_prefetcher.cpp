#include "haptic/loop/tile_prefetcher.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <utility>

#include <sys/mman.h>
#include <unistd.h>

#include "engine/base/thread_priority.h"
#include "engine/field/tile_store.h"

namespace fettle::haptic {

namespace {

constexpr std::chrono::milliseconds kPollInterval{1};
constexpr std::size_t kMostTiles = 2 * (2 * TilePrefetcher::kTiles + 1) * (2 * TilePrefetcher::kTiles + 1);

// The whole pages that a tile touches.
std::pair<char*, std::size_t> pagesOf(const engine::Tile* tile) noexcept {
  static const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const auto begin = reinterpret_cast<std::uintptr_t>(tile) & ~(page - 1);
  const auto end = (reinterpret_cast<std::uintptr_t>(tile + 1) + page - 1) & ~(page - 1);
  return {reinterpret_cast<char*>(begin), end - begin};
}

// Reads every page of a tile; true if they were locked as well.
bool lockTile(const engine::Tile* tile) noexcept {
  const auto [begin, bytes] = pagesOf(tile);
  if (mlock(begin, bytes) == 0) return true;
  const auto* at = reinterpret_cast<const volatile char*>(tile);
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  for (std::size_t i = 0; i < sizeof *tile; i += page) static_cast<void>(at[i]);
  static_cast<void>(at[sizeof *tile - 1]);
  return false;
}

void unlockTile(const engine::Tile* tile) noexcept {
  const auto [begin, bytes] = pagesOf(tile);
  munlock(begin, bytes);
}

}  // namespace

TilePrefetcher::TilePrefetcher() {
  for (auto* tiles : {&locked_, &next_, &outdated_}) tiles->reserve(kMostTiles);
}

TilePrefetcher::~TilePrefetcher() {
  stop_.store(true, std::memory_order_relaxed);
  if (thread_.joinable()) thread_.join();
  for (const engine::Tile* tile : locked_) unlockTile(tile);
  for (const engine::Tile* tile : outdated_) unlockTile(tile);
}

void TilePrefetcher::start() {
  thread_ = std::thread([this] {
    engine::takeNormalPriority();
    // Relaxed: a stop may be seen one round late.
    while (!stop_.load(std::memory_order_relaxed)) {
      prefetch();
      std::this_thread::sleep_for(kPollInterval);
    }
  });
}

bool TilePrefetcher::ready(const engine::LiveField& field, const engine::Version& original,
                           const engine::SampleRect& rect, std::int32_t column, std::int32_t row) noexcept {
  // A full ring means that the prefetcher waits for the disk: the state is sent with a later tick.
  if (!announced_ && followed_.freePlaces() > 0)
    announced_ = followed_.push(FollowedState{field.snapshot(), original, state_});
  using engine::kTileShift;
  const Place at{static_cast<std::uint16_t>(column >> kTileShift),
                 static_cast<std::uint16_t>(row >> kTileShift), state_};
  // Relaxed: only a request. The state itself goes through the ring.
  requested_.store(at, std::memory_order_relaxed);
  // Acquire pairs with prefetch(): the pages were read before.
  const Place available = available_.load(std::memory_order_acquire);
  if (available.state != state_) return false;
  return (rect.column >> kTileShift) >= available.column - kTiles &&
         ((rect.column + rect.columns - 1) >> kTileShift) <= available.column + kTiles &&
         (rect.row >> kTileShift) >= available.row - kTiles &&
         ((rect.row + rect.rows - 1) >> kTileShift) <= available.row + kTiles;
}

void TilePrefetcher::collect(const engine::Version& version, const Place& around) noexcept {
  const engine::TileStore* store = version.memory()->store.get();
  if (store == nullptr) return;
  const engine::FieldReader reader = version.reader();
  for (int tr = std::max(around.row - kTiles, 0); tr <= std::min(around.row + kTiles, reader.tileRows() - 1);
       ++tr)
    for (int tc = std::max(around.column - kTiles, 0);
         tc <= std::min(around.column + kTiles, reader.tileColumns() - 1); ++tc) {
      const engine::Tile* tile = &reader.tile(tc, tr);
      if (store->holds(tile)) next_.push_back(tile);
    }
}

void TilePrefetcher::prefetch() noexcept {
  for (const engine::Tile* tile : outdated_) unlockTile(tile);
  const bool some_outdated = !outdated_.empty();
  outdated_.clear();
  FollowedState before;
  for (FollowedState next; followed_.pop(next);) {
    // The tiles that are still locked belong to it: it is released after they are unlocked.
    if (before.number == 0) before = std::move(held_);
    held_ = std::move(next);
  }
  if (held_.number == 0) return;
  Place around = requested_.load(std::memory_order_relaxed);
  around.state = held_.number;
  // A page may be shared by a tile that was unlocked and one that stays: locked again below.
  if (!some_outdated && around == available_.load(std::memory_order_relaxed)) return;

  next_.clear();
  collect(held_.live, around);
  collect(held_.original, around);
  std::ranges::sort(next_);
  const auto twice = std::unique(next_.begin(), next_.end());
  next_.erase(twice, next_.end());
  for (const engine::Tile* tile : next_) {
    if (!lockTile(tile)) not_locked_.fetch_add(1, std::memory_order_relaxed);
    if (!std::ranges::binary_search(locked_, tile)) prefetched_.fetch_add(1, std::memory_order_relaxed);
  }
  // Release: a thread that reads this place may read the tiles.
  available_.store(around, std::memory_order_release);
  // Unlocked in the next round: a running tick may still use the previous place.
  std::ranges::set_difference(locked_, next_, std::back_inserter(outdated_));
  std::swap(locked_, next_);
}

}  // namespace fettle::haptic
