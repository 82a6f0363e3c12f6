#pragma once

#include <array>
#include <atomic>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>

#include "engine/field/tile.h"

namespace fettle::engine {

/// Source of a pool's slabs other than the heap.
class SlabSource {
 public:
  virtual ~SlabSource() = default;
  /// `bytes` of memory, all zero, at a multiple of `bytes` (a power of two); null when there is no more. It
  /// stays until the source is destroyed. Threading: one call at a time, under the pool's lock.
  [[nodiscard]] virtual void* take(std::size_t bytes) noexcept = 0;
};

/// Preallocated objects of one type, counted by reference, for the field's tiles and nodes.
///
/// Objects lie in slabs whose address is a multiple of their size, so that an object finds its counter, its
/// free-list link and its pool from its own address. Counters of neighbouring objects are adjacent: copying a
/// node takes 64 references, which are then in a few cache lines instead of 64.
///
/// Threading: tryAcquire, retain and release may be called from any thread. They are lock-free (a loop of
/// compare-and-swap that only repeats when another thread succeeded), never allocate and never call the
/// system. grow() takes a lock and allocates: never on the haptic thread.
///
/// The free list is R. K. Treiber's stack (1986); the head carries a count of pops, so that a node that was
/// popped and pushed again between a reader's two reads is not mistaken for the same one (the ABA problem).
template <class T, std::size_t kSlabBytes>
class ObjectPool {
 public:
  ObjectPool() = default;
  /// Takes its slabs from `source`, which outlives it; their pages are not populated beforehand.
  explicit ObjectPool(SlabSource& source) noexcept : source_(&source) {}
  ObjectPool(const ObjectPool&) = delete;
  ObjectPool& operator=(const ObjectPool&) = delete;
  ~ObjectPool();

  /// An object with one reference and unspecified content, or null when none is free.
  [[nodiscard]] T* tryAcquire() noexcept;

  /// As tryAcquire, growing by one slab when empty. Null only when memory or the address table is exhausted.
  [[nodiscard]] T* acquire() noexcept;

  /// Makes at least `objects` free; false when memory ran out. Locks and allocates; large requests on all
  /// cores.
  bool reserve(std::size_t objects) noexcept;

  [[nodiscard]] std::size_t freeObjects() const noexcept { return free_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::size_t liveObjects() const noexcept {
    return total_.load(std::memory_order_relaxed) - freeObjects();
  }

  static void retain(const T* object) noexcept {
    // Relaxed: a thread that copies a reference holds one already, so the object cannot be freed meanwhile.
    counter(object).fetch_add(1, std::memory_order_relaxed);
  }

  /// True when the caller held the last reference and now must recycle() the object.
  [[nodiscard]] static bool dropLast(const T* object) noexcept {
    // Release: this thread's reads of the object precede the decrement. Acquire: the thread that sees zero
    // comes after all reads, and may overwrite.
    return counter(object).fetch_sub(1, std::memory_order_acq_rel) == 1;
  }

  /// Whether the caller holds the only reference, and so may write in place.
  [[nodiscard]] static bool unique(const T* object) noexcept {
    // Acquire pairs with the release half of dropLast: other holders' reads are complete.
    return counter(object).load(std::memory_order_acquire) == 1;
  }

  /// Puts an object without references back on its pool's free list.
  static void recycle(T* object) noexcept;

 private:
  static constexpr std::size_t kCount = (kSlabBytes - 128) / (sizeof(T) + 2 * sizeof(std::uint32_t));
  static constexpr std::size_t kMaxSlabs = 16384;

  struct Slab {
    ObjectPool* pool;
    std::uint32_t first;  // pool-wide number of items[0]
    std::array<std::atomic<std::uint32_t>, kCount> refs;
    std::array<std::atomic<std::uint32_t>, kCount> next;  // number + 1 of the next free object, 0 = none
    alignas(alignof(T)) std::array<T, kCount> items;
  };
  static_assert(sizeof(Slab) <= kSlabBytes);

  static Slab* slabOf(const T* object) noexcept {
    return reinterpret_cast<Slab*>(reinterpret_cast<std::uintptr_t>(object) & ~(kSlabBytes - 1));
  }
  static std::size_t indexOf(const Slab* slab, const T* object) noexcept {
    return static_cast<std::size_t>(object - slab->items.data());
  }
  static std::atomic<std::uint32_t>& counter(const T* object) noexcept {
    Slab* slab = slabOf(object);
    return slab->refs[indexOf(slab, object)];
  }
  Slab* addSlab() noexcept;
  Slab* takeIn(void* memory) noexcept;
  void push(Slab* slab, std::size_t index) noexcept;

  std::atomic<std::uint64_t> head_{0};  // pops << 32 | number + 1
  std::atomic<std::size_t> free_{0};
  std::atomic<std::size_t> total_{0};
  std::array<std::atomic<Slab*>, kMaxSlabs> slabs_{};
  std::mutex grow_;
  std::size_t slab_count_ = 0;  // guarded by grow_
  SlabSource* source_ = nullptr;
};

using TilePool = ObjectPool<Tile, std::size_t{4} << 20>;
using InnerPool = ObjectPool<Node, std::size_t{1} << 20>;
extern template class ObjectPool<Tile, std::size_t{4} << 20>;
extern template class ObjectPool<Node, std::size_t{1} << 20>;

class TileStore;

/// The memory that all versions of a field share; it exists as long as the last of them.
///
/// With a store (tile_store.h) whole fields lie in a mapped file, and touching one of their tiles may wait
/// for the disk; tiles that a stroke writes, and every node with its bounds, still lie in ordinary memory. A
/// tile always returns to the pool that it came from.
struct FieldMemory {
  FieldMemory();
  explicit FieldMemory(std::unique_ptr<TileStore> tile_store);
  ~FieldMemory();

  const std::unique_ptr<TileStore> store;  ///< null: all in ordinary memory
  TilePool tiles;                          ///< in ordinary memory: for code that may not wait
  InnerPool nodes;

  /// For code that may wait: import, filters, jobs. The stored tiles when there is a store, else `tiles`.
  [[nodiscard]] TilePool& bulk() noexcept { return stored_ ? *stored_ : tiles; }

 private:
  std::unique_ptr<TilePool> stored_;
};

/// Drops one reference to a tile; recycles it when that was the last.
inline void releaseTile(Tile* tile) noexcept {
  if (tile != nullptr && TilePool::dropLast(tile)) TilePool::recycle(tile);
}

/// Drops one reference to a node; when that was the last, its children's too, then recycles it.
void releaseNode(Node* node) noexcept;

/// A counted reference to a tile, outside the tree. Empty by default.
class TileRef {
 public:
  TileRef() = default;
  /// Takes over a reference that the caller holds.
  static TileRef adopt(Tile* tile) noexcept {
    TileRef ref;
    ref.tile_ = tile;
    return ref;
  }
  /// Adds a reference.
  static TileRef share(const Tile* tile) noexcept {
    if (tile != nullptr) TilePool::retain(tile);
    return adopt(const_cast<Tile*>(tile));
  }
  TileRef(const TileRef& other) noexcept : TileRef(share(other.tile_)) {}
  TileRef(TileRef&& other) noexcept : tile_(std::exchange(other.tile_, nullptr)) {}
  TileRef& operator=(TileRef other) noexcept {
    std::swap(tile_, other.tile_);
    return *this;
  }
  ~TileRef() { releaseTile(tile_); }

  [[nodiscard]] Tile* get() const noexcept { return tile_; }
  Tile* operator->() const noexcept { return tile_; }
  Tile& operator*() const noexcept { return *tile_; }
  explicit operator bool() const noexcept { return tile_ != nullptr; }
  /// Transfers the reference to the caller.
  [[nodiscard]] Tile* detach() noexcept { return std::exchange(tile_, nullptr); }

 private:
  Tile* tile_ = nullptr;
};

}  // namespace fettle::engine
