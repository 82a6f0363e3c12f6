#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace fettle::haptic {

/// Passes the newest value of a stream from one thread to one other. There are three buffers: one belongs to
/// the writer, one to the reader, and the third is exchanged between them. publish() swaps the writer's
/// buffer with the third, take() swaps the reader's with it, so neither ever waits and no value is read half
/// written. (Simpson, Four-slot fully asynchronous communication mechanism, 1990, does the same without a
/// swap instruction, with a fourth slot.) What was not taken before the next publish is dropped: for events
/// that must all arrive use a ring.
///
/// Threading: one writer thread calls publish(), one reader thread take() and latest(); both wait-free.
template <class T>
class LatestSlot {
  static_assert(std::is_trivially_copyable_v<T>, "a value is copied while its old one may still be read");
  static_assert(std::atomic<std::uint8_t>::is_always_lock_free);

 public:
  /// latest() is `initial` until the first take of a published value.
  explicit LatestSlot(const T& initial = T{}) noexcept { buffers_.fill({initial}); }
  LatestSlot& operator=(LatestSlot&&) = delete;

  /// Writer thread.
  void publish(const T& value) noexcept {
    buffers_[back_].value = value;
    // Release: the copy above is complete for the reader that takes this index. Acquire: the reader has
    // finished with the buffer that comes back before the next publish writes to it.
    const std::uint8_t old =
        middle_.exchange(static_cast<std::uint8_t>(back_ | kFresh), std::memory_order_acq_rel);
    back_ = old & kIndex;
  }

  /// Reader thread: makes the newest published value latest(). False when there is none since last time.
  bool take() noexcept {
    // Relaxed: only a hint. Only the reader clears the bit, so a set bit stays set until the exchange below
    // synchronises; seeing it late costs one call.
    if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    // Acquire: sees the whole value of the publish that set the bit. Release: this thread's reads of the
    // returned buffer come before the writer's next write to it.
    const std::uint8_t old = middle_.exchange(front_, std::memory_order_acq_rel);
    front_ = old & kIndex;
    return true;
  }

  /// Reader thread: the value of the last take() that returned true. Valid until the next take().
  [[nodiscard]] const T& latest() const noexcept { return buffers_[front_].value; }

 private:
  static constexpr std::uint8_t kIndex = 3;
  static constexpr std::uint8_t kFresh = 4;
  static constexpr std::size_t kLine = 64;  // cache line: the two threads never write to the same one

  struct alignas(kLine) Buffer {
    T value;
  };
  std::array<Buffer, 3> buffers_{};
  alignas(kLine) std::atomic<std::uint8_t> middle_{1};
  alignas(kLine) std::uint8_t back_ = 0;   // writer's own
  alignas(kLine) std::uint8_t front_ = 2;  // reader's own
};

}  // namespace fettle::haptic
