#pragma once

#include <atomic>
#include <cassert>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

namespace fettle::haptic {

/// A bounded queue from one thread to one other, for records that own things (versions, scenes) and so must
/// be moved, not copied: a popped or refused record leaves nothing behind that would later be freed on the
/// wrong thread. (boost::lockfree::spsc_queue copies on push and assigns on pop, which frees on the
/// consumer.)
///
/// Two counters that only grow, each written by one side and cached by the other. Sources: Lamport, "Proving
/// the correctness of multiprocess programs" (1977); the cached counters: Lee, Bu, Chandranmenon, "A
/// lock-free, cache-efficient shared ring buffer" (2010).
///
/// Threading: one producer thread (push, freePlaces), one consumer thread (pop, waiting); all wait-free,
/// noexcept, nothing allocates but the constructor. Construct and destroy while no thread uses it.
template <class T>
class SpscRing {
  static_assert(std::is_nothrow_move_assignable_v<T> && std::is_default_constructible_v<T>);
  static_assert(std::atomic<std::size_t>::is_always_lock_free);

 public:
  /// `capacity` records, a power of two.
  explicit SpscRing(std::size_t capacity) : slots_(new T[capacity]), mask_(capacity - 1) {
    assert(capacity > 0 && (capacity & mask_) == 0);
  }
  SpscRing& operator=(SpscRing&&) = delete;

  [[nodiscard]] std::size_t capacity() const noexcept { return mask_ + 1; }

  /// Producer: false, and `record` untouched, when full.
  [[nodiscard]] bool push(T&& record) noexcept {
    if (freePlaces() == 0) return false;
    // Relaxed: only this thread writes it.
    const std::size_t at = pushed_.load(std::memory_order_relaxed);
    slots_[at & mask_] = std::move(record);
    // Release publishes the record to pop's acquire.
    pushed_.store(at + 1, std::memory_order_release);
    return true;
  }

  /// Producer: number of pushes that are certain to succeed.
  [[nodiscard]] std::size_t freePlaces() noexcept {
    const std::size_t pushed = pushed_.load(std::memory_order_relaxed);
    if (pushed - popped_seen_ > mask_ / 2)
      // Acquire: the consumer has moved everything out of the places it counts as popped.
      popped_seen_ = popped_.load(std::memory_order_acquire);
    return capacity() - (pushed - popped_seen_);
  }

  /// Consumer: moves the oldest record to `out`; false when empty.
  [[nodiscard]] bool pop(T& out) noexcept {
    const std::size_t at = popped_.load(std::memory_order_relaxed);
    if (at == pushed_seen_) {
      pushed_seen_ = pushed_.load(std::memory_order_acquire);
      if (at == pushed_seen_) return false;
    }
    out = std::move(slots_[at & mask_]);
    // Release: the place is empty for push's acquire.
    popped_.store(at + 1, std::memory_order_release);
    return true;
  }

  /// Consumer: number of pops that are certain to succeed.
  [[nodiscard]] std::size_t waiting() noexcept {
    pushed_seen_ = pushed_.load(std::memory_order_acquire);
    return pushed_seen_ - popped_.load(std::memory_order_relaxed);
  }

 private:
  static constexpr std::size_t kLine = 64;

  std::unique_ptr<T[]> slots_;
  std::size_t mask_;
  alignas(kLine) std::atomic<std::size_t> pushed_{0};
  std::size_t popped_seen_ = 0;  // producer's
  alignas(kLine) std::atomic<std::size_t> popped_{0};
  std::size_t pushed_seen_ = 0;  // consumer's
};

}  // namespace fettle::haptic
