#include "haptic/loop/near_tiles.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <iterator>
#include <utility>

#include <sys/mman.h>
#include <unistd.h>

#include "engine/field/tile_store.h"

namespace fettle::haptic {

namespace {

constexpr std::chrono::milliseconds kLookEvery{1};
constexpr std::size_t kMostTiles = 2 * (2 * NearTiles::kTiles + 1) * (2 * NearTiles::kTiles + 1);

// The whole pages that a tile touches.
std::pair<char*, std::size_t> pagesOf(const engine::Tile* tile) noexcept {
  static const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const auto begin = reinterpret_cast<std::uintptr_t>(tile) & ~(page - 1);
  const auto end = (reinterpret_cast<std::uintptr_t>(tile + 1) + page - 1) & ~(page - 1);
  return {reinterpret_cast<char*>(begin), end - begin};
}

// Reads every page of a tile; true if they are locked as well.
bool hold(const engine::Tile* tile) noexcept {
  const auto [begin, bytes] = pagesOf(tile);
  if (mlock(begin, bytes) == 0) return true;
  const auto* at = reinterpret_cast<const volatile char*>(tile);
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  for (std::size_t i = 0; i < sizeof *tile; i += page) static_cast<void>(at[i]);
  static_cast<void>(at[sizeof *tile - 1]);
  return false;
}

void letGo(const engine::Tile* tile) noexcept {
  const auto [begin, bytes] = pagesOf(tile);
  munlock(begin, bytes);
}

}  // namespace

NearTiles::NearTiles() {
  for (auto* tiles : {&locked_, &next_, &behind_}) tiles->reserve(kMostTiles);
}

NearTiles::~NearTiles() {
  stop_.store(true, std::memory_order_relaxed);
  if (thread_.joinable()) thread_.join();
  for (const engine::Tile* tile : locked_) letGo(tile);
  for (const engine::Tile* tile : behind_) letGo(tile);
}

void NearTiles::start() {
  thread_ = std::thread([this] {
    // Relaxed: a stop may be seen one look late.
    while (!stop_.load(std::memory_order_relaxed)) {
      bring();
      std::this_thread::sleep_for(kLookEvery);
    }
  });
}

bool NearTiles::ready(const engine::LiveField& field, const engine::Version& original,
                      const engine::SampleRect& rect, std::int32_t column, std::int32_t row) noexcept {
  // A full ring means a keeper that waits for the disk: it is told with a later tick.
  if (!told_ && followed_.freePlaces() > 0)
    told_ = followed_.push(FollowedState{field.snapshot(), original, state_});
  using engine::kTileShift;
  const Place at{static_cast<std::uint16_t>(column >> kTileShift),
                 static_cast<std::uint16_t>(row >> kTileShift), state_};
  // Relaxed: a wish. The state itself goes through the ring.
  wanted_.store(at, std::memory_order_relaxed);
  // Acquire pairs with bring(): the pages were read before.
  const Place near = near_.load(std::memory_order_acquire);
  if (near.state != state_) return false;
  return (rect.column >> kTileShift) >= near.column - kTiles &&
         ((rect.column + rect.columns - 1) >> kTileShift) <= near.column + kTiles &&
         (rect.row >> kTileShift) >= near.row - kTiles &&
         ((rect.row + rect.rows - 1) >> kTileShift) <= near.row + kTiles;
}

void NearTiles::collect(const engine::Version& version, const Place& around) noexcept {
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

void NearTiles::bring() noexcept {
  for (const engine::Tile* tile : behind_) letGo(tile);
  const bool some_behind = !behind_.empty();
  behind_.clear();
  FollowedState before;
  for (FollowedState newest; followed_.pop(newest);) {
    // The tiles that are still locked belong to it: let go of when theirs are.
    if (before.number == 0) before = std::move(held_);
    held_ = std::move(newest);
  }
  if (held_.number == 0) return;
  Place around = wanted_.load(std::memory_order_relaxed);
  around.state = held_.number;
  // A page may be shared by a tile that was let go of and one that stays: locked again below.
  if (!some_behind && around == near_.load(std::memory_order_relaxed)) return;

  next_.clear();
  collect(held_.live, around);
  collect(held_.original, around);
  std::ranges::sort(next_);
  const auto twice = std::unique(next_.begin(), next_.end());
  next_.erase(twice, next_.end());
  for (const engine::Tile* tile : next_) {
    if (!hold(tile)) not_locked_.fetch_add(1, std::memory_order_relaxed);
    if (!std::ranges::binary_search(locked_, tile)) brought_.fetch_add(1, std::memory_order_relaxed);
  }
  // Release: whoever sees this place may read the tiles.
  near_.store(around, std::memory_order_release);
  // Unlocked at the next look: a tick that is under way may still go by the place before this one.
  std::ranges::set_difference(locked_, next_, std::back_inserter(behind_));
  std::swap(locked_, next_);
}

}  // namespace fettle::haptic
