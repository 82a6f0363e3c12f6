#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>

#include "engine/base/stopwatch.h"
#include "render/vulkan/memory.h"

namespace fettle::render {

/// Command buffers submitted to one queue, two in flight at a time. Each has a number, from 1 up; they
/// complete in that order.
///
/// Threading: as Context. Throws vk::SystemError.
class Submissions {
 public:
  static constexpr std::uint64_t kInFlight = 2;

  explicit Submissions(Context& context);
  ~Submissions();

  /// Starts recording submission next(), after waiting for the one kInFlight before it; returns the
  /// milliseconds of that wait.
  double begin();
  [[nodiscard]] const vk::raii::CommandBuffer& commands() const noexcept { return slot(next_).commands; }
  struct Gate {
    vk::Semaphore wait;                                                          ///< null: none
    vk::PipelineStageFlags2 wait_at = vk::PipelineStageFlagBits2::eAllCommands;  ///< what has to wait for it
    vk::Semaphore signal;                                                        ///< null: none
  };
  /// Ends recording and submits.
  void submit(const Gate& gate);

  /// Number of the submission being recorded, or to be recorded next.
  [[nodiscard]] std::uint64_t next() const noexcept { return next_; }
  /// Number of the latest submission known to be completed; asks the device, does not wait.
  std::uint64_t done();
  /// From submission to when its completion was detected, of the last one [ms]; negative before the first.
  [[nodiscard]] double lastMs() const noexcept { return last_ms_; }
  /// Waits until this one is completed; it was submitted, as one of the last kInFlight or earlier.
  void waitFor(std::uint64_t number);
  /// Waits until all are completed.
  void finish();

 private:
  struct Slot {
    vk::raii::CommandBuffer commands = nullptr;
    vk::raii::Fence fence = nullptr;
    engine::Stopwatch since_sent;
  };
  [[nodiscard]] const Slot& slot(std::uint64_t number) const noexcept { return slots_[number % kInFlight]; }
  [[nodiscard]] Slot& slot(std::uint64_t number) noexcept { return slots_[number % kInFlight]; }

  Context& context_;
  vk::raii::CommandPool pool_ = nullptr;
  std::array<Slot, kInFlight> slots_;
  std::uint64_t next_ = 1;
  std::uint64_t done_ = 0;
  double last_ms_ = -1.0;
};

/// A permanently mapped ring buffer that the CPU writes and the device copies from: what a submission took is
/// free again when it is completed.
class StagingRing {
 public:
  StagingRing(const Context& context, vk::DeviceSize bytes)
      : buffer_(context, bytes, vk::BufferUsageFlagBits::eTransferSrc) {}

  /// Offset at which `bytes` (at most half the ring) may be written for submission `number`; empty when
  /// earlier ones still hold the room. Offsets are multiples of 16.
  [[nodiscard]] std::optional<vk::DeviceSize> take(vk::DeviceSize bytes, std::uint64_t number);
  /// Submissions up to this one are completed.
  void release(std::uint64_t number);

  [[nodiscard]] const Buffer& buffer() const noexcept { return buffer_; }

 private:
  struct Held {
    std::uint64_t number;
    vk::DeviceSize end;  // of its range
  };
  Buffer buffer_;
  std::deque<Held> held_;    // oldest first
  vk::DeviceSize head_ = 0;  // next free byte
  vk::DeviceSize tail_ = 0;  // first byte still held; equal to head_ and nothing held: all free
};

}  // namespace fettle::render
