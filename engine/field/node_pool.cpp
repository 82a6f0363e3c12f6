#include "engine/field/node_pool.h"

#include <cstddef>
#include <cstdlib>
#include <new>

#include <sys/mman.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "engine/field/tile_store.h"

namespace fettle::engine {

namespace {

// A slab's memory. `whole`: large pages, and all of them now.
void* slabMemory(std::size_t bytes, bool whole) noexcept {
  void* memory = std::aligned_alloc(bytes, bytes);
  if (memory == nullptr || !whole) return memory;
  (void)madvise(memory, bytes, MADV_HUGEPAGE);  // may be refused
  // By writing, not by MADV_POPULATE_WRITE: that holds the lock of the process's memory map while a page is cleared, and a thread
  // that maps memory waits for it, as a driver's does that loads code: for half a second beside a filter. Since Linux 6.4 a
  // fault holds a lock of its own area alone.
  constexpr std::size_t kSmallestPage = 4096;
  for (std::size_t i = 0; i < bytes; i += kSmallestPage)
    static_cast<volatile std::byte*>(memory)[i] = std::byte{0};
  return memory;
}

}  // namespace

template <class T, std::size_t kSlabBytes>
ObjectPool<T, kSlabBytes>::~ObjectPool() {
  if (source_ != nullptr) return;
  for (std::size_t s = 0; s < slab_count_; ++s) std::free(slabs_[s].load(std::memory_order_relaxed));
}

template <class T, std::size_t kSlabBytes>
auto ObjectPool<T, kSlabBytes>::addSlab() noexcept -> Slab* {
  // A store keeps the first page of a slab, and so all that is counted, in ordinary memory.
  static_assert(!std::is_same_v<T, Tile> || sizeof(Slab) - sizeof(Slab::items) <= 4096);
  if (slab_count_ == kMaxSlabs) return nullptr;
  if (source_ != nullptr) return takeIn(source_->take(kSlabBytes));
  // From the second slab on (small fields stay small) large pages, because a stroke covers more tiles than
  // the TLB has entries for small pages: 3 % of a tick on 4096 x 4096 samples. And all of them populated now,
  // because the haptic thread must not take page faults.
  return takeIn(slabMemory(kSlabBytes, slab_count_ > 0));
}

template <class T, std::size_t kSlabBytes>
auto ObjectPool<T, kSlabBytes>::takeIn(void* memory) noexcept -> Slab* {
  if (memory == nullptr) return nullptr;
  if (slab_count_ >= kMaxSlabs) {
    std::free(memory);
    return nullptr;
  }
  Slab* slab = static_cast<Slab*>(memory);
  slab->pool = this;
  slab->first = static_cast<std::uint32_t>(slab_count_ * kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    new (&slab->refs[i]) std::atomic<std::uint32_t>(0);
    new (&slab->next[i]) std::atomic<std::uint32_t>(0);
  }
  // Release pairs with the acquire in tryAcquire: a thread that reads a number of this slab sees it
  // initialised.
  slabs_[slab_count_++].store(slab, std::memory_order_release);
  total_.fetch_add(kCount, std::memory_order_relaxed);
  for (std::size_t i = kCount; i-- > 0;) push(slab, i);
  return slab;
}

template <class T, std::size_t kSlabBytes>
void ObjectPool<T, kSlabBytes>::push(Slab* slab, std::size_t index) noexcept {
  // Counted before it is published: the count may briefly be one too high, never below zero.
  free_.fetch_add(1, std::memory_order_relaxed);
  const std::uint64_t number = slab->first + index + 1;
  std::uint64_t head = head_.load(std::memory_order_relaxed);
  do {
    slab->next[index].store(static_cast<std::uint32_t>(head), std::memory_order_relaxed);
    // Release publishes next[index] and all changes of the object before it was returned.
  } while (!head_.compare_exchange_weak(head, (head & ~std::uint64_t{0xffffffff}) | number,
                                        std::memory_order_release, std::memory_order_relaxed));
}

template <class T, std::size_t kSlabBytes>
T* ObjectPool<T, kSlabBytes>::tryAcquire() noexcept {
  // Acquire pairs with push's release.
  std::uint64_t head = head_.load(std::memory_order_acquire);
  for (;;) {
    const auto number = static_cast<std::uint32_t>(head);
    if (number == 0) return nullptr;
    Slab* slab = slabs_[(number - 1) / kCount].load(std::memory_order_acquire);
    const std::size_t index = (number - 1) % kCount;
    // May read the link of an object that another thread has popped meanwhile: the slab is never unmapped,
    // the value is then outdated, and the pop count in the head makes the exchange fail.
    const std::uint64_t next = slab->next[index].load(std::memory_order_relaxed);
    const std::uint64_t pops = (head >> 32) + 1;
    if (head_.compare_exchange_weak(head, pops << 32 | next, std::memory_order_acquire,
                                    std::memory_order_acquire)) {
      free_.fetch_sub(1, std::memory_order_relaxed);
      slab->refs[index].store(1, std::memory_order_relaxed);
      return &slab->items[index];
    }
  }
}

template <class T, std::size_t kSlabBytes>
T* ObjectPool<T, kSlabBytes>::acquire() noexcept {
  for (;;) {
    if (T* object = tryAcquire()) return object;
    const std::scoped_lock lock(grow_);
    if (freeObjects() == 0 && addSlab() == nullptr) return nullptr;
  }
}

template <class T, std::size_t kSlabBytes>
bool ObjectPool<T, kSlabBytes>::reserve(std::size_t objects) noexcept {
  const std::scoped_lock lock(grow_);
  // The system clears the pages of a large field, which takes as long as reading its samples: on all cores.
  constexpr std::size_t kAtOnce = 16;
  while (freeObjects() < objects) {
    const std::size_t missing = (objects - freeObjects() + kCount - 1) / kCount;
    if (source_ != nullptr || slab_count_ == 0 || missing < kAtOnce) {
      if (addSlab() == nullptr) return false;
      continue;
    }
    std::array<void*, kAtOnce> memory{};
    tbb::this_task_arena::isolate([&memory] {  // no other work under the lock
      tbb::parallel_for(std::size_t{0}, kAtOnce,
                        [&memory](std::size_t i) { memory[i] = slabMemory(kSlabBytes, true); });
    });
    bool taken = true;
    for (void* each : memory) taken = takeIn(each) != nullptr && taken;
    if (!taken) return false;
  }
  return true;
}

template <class T, std::size_t kSlabBytes>
void ObjectPool<T, kSlabBytes>::recycle(T* object) noexcept {
  Slab* slab = slabOf(object);
  slab->pool->push(slab, indexOf(slab, object));
}

template class ObjectPool<Tile, std::size_t{4} << 20>;
template class ObjectPool<Node, std::size_t{1} << 20>;

FieldMemory::FieldMemory() = default;

FieldMemory::FieldMemory(std::unique_ptr<TileStore> tile_store)
    : store(std::move(tile_store)), stored_(store ? std::make_unique<TilePool>(*store) : nullptr) {}

FieldMemory::~FieldMemory() = default;

void releaseNode(Node* node) noexcept {
  if (node == nullptr || !InnerPool::dropLast(node)) return;
  // At most kMaxLevel deep: the recursion is bounded by the height of the tree, not by its size.
  for (void* child : node->children) {
    if (node->level == 2)
      releaseTile(static_cast<Tile*>(child));
    else
      releaseNode(static_cast<Node*>(child));
  }
  InnerPool::recycle(node);
}

}  // namespace fettle::engine
