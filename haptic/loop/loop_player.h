#pragma once

#include <cstdint>
#include <memory>

#include "engine/base/error.h"
#include "haptic/loop/loop_tick.h"
#include "haptic/scene/scene.h"

namespace fettle::haptic {

/// What a live loop was given, played again without thread, clock or device: the very LoopTick of the live
/// loop, tick by tick, each command in the tick that took it. Same start, inputs and commands: same bits, of
/// the field and of everything the loop answers.
///
/// Threading: one thread; run() takes the loop's floating-point state (DenormalScope) and gives it back.
class LoopPlayer {
 public:
  /// `start` and `original` the right way up, as for HapticLoop. Errors (kInput): a scene out of range, grids
  /// that differ.
  [[nodiscard]] static engine::Result<std::unique_ptr<LoopPlayer>> create(const engine::Version& start,
                                                                          const engine::Version& original,
                                                                          const Scene& scene);
  ~LoopPlayer();

  /// One tick with the input that was recorded (TickRecord::input). Its time must be what the loop measured:
  /// seconds since its first tick, to the nanosecond. Errors (kFailed): memory ran out.
  [[nodiscard]] engine::Status run(const StrokeSample& input);
  /// The same with a command taken first, one that has an answer; the answer.
  [[nodiscard]] engine::Result<LoopEvent> run(const StrokeSample& input, LoopCommand&& command);

  /// Ticks so far.
  [[nodiscard]] std::uint64_t ticks() const noexcept;
  /// The field after them, as felt.
  [[nodiscard]] engine::Version field() const;

 private:
  class Input;
  explicit LoopPlayer(const engine::Version& start, const engine::Version& original, const Scene& scene);

  std::shared_ptr<engine::FieldMemory> memory_;
  std::unique_ptr<Input> input_;
  LoopOptions options_;
  LoopChannels channels_;
  mutable LoopTick loop_;  // hands its field out as a reference that may be written
};

}  // namespace fettle::haptic
