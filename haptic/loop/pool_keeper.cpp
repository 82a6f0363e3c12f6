#include "haptic/loop/pool_keeper.h"

#include <chrono>

#include <sys/mman.h>

#include "engine/base/thread_priority.h"

#ifndef MADV_POPULATE_WRITE
#define MADV_POPULATE_WRITE 23  // Linux 5.14
#endif

namespace fettle::haptic {

namespace {

// Populates the pages of the only slab, which alone does not come with them: the object on top of the free list lies in it, and a
// slab lies at a multiple of its size. An older kernel refuses; then the loop takes a page fault when it first writes to a page.
template <class T, std::size_t kSlabBytes>
void populateFirst(engine::ObjectPool<T, kSlabBytes>& pool) noexcept {
  T* object = pool.tryAcquire();
  if (object == nullptr) return;
  const std::uintptr_t slab = reinterpret_cast<std::uintptr_t>(object) & ~std::uintptr_t{kSlabBytes - 1};
  madvise(reinterpret_cast<void*>(slab), kSlabBytes, MADV_POPULATE_WRITE);
  // Not releaseNode: the object was never written, it has no children.
  if (engine::ObjectPool<T, kSlabBytes>::dropLast(object)) engine::ObjectPool<T, kSlabBytes>::recycle(object);
}

template <class T, std::size_t kSlabBytes>
bool fill(engine::ObjectPool<T, kSlabBytes>& pool, std::size_t level, bool& grew) noexcept {
  for (std::size_t free = pool.freeObjects(); free < level; free = pool.freeObjects()) {
    const bool first = free + pool.liveObjects() == 0;
    if (!pool.reserve(free + 1)) return false;
    if (first) populateFirst(pool);
    grew = true;
  }
  return true;
}

}  // namespace

PoolKeeper::PoolKeeper(std::shared_ptr<engine::FieldMemory> memory, const Levels& levels)
    : memory_(std::move(memory)), levels_(levels) {
  topUp();
  thread_ = std::thread([this] {
    // Filters take tiles from the same pools: clearing pages for them must not come before what draws.
    engine::takeNormalPriority();
    while (!stop_.load(std::memory_order_relaxed)) {
      std::this_thread::sleep_for(std::chrono::nanoseconds(levels_.poll_interval_ns));
      topUp();
    }
  });
}

PoolKeeper::~PoolKeeper() {
  stop_.store(true, std::memory_order_relaxed);
  thread_.join();
}

void PoolKeeper::topUp() noexcept {
  bool grew = false;
  const bool tiles = fill(memory_->tiles, levels_.tiles, grew);
  const bool nodes = fill(memory_->nodes, levels_.nodes, grew);
  if (grew) grown_.fetch_add(1, std::memory_order_relaxed);
  if (!tiles || !nodes) failed_.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace fettle::haptic
