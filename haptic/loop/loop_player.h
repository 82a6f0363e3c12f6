#pragma once

#include <cstdint>
#include <memory>

#include "engine/base/error.h"
#include "haptic/loop/loop_tick.h"
#include "haptic/scene/scene.h"

namespace fettle::haptic {

/// Replays the inputs and commands of a live loop without thread, clock or device: with the LoopTick of the
/// live loop, tick by tick, each command in the tick that took it. With the same start, inputs and commands
/// the field and all answers of the loop are bit-identical.
///
/// Threading: one thread; run() sets the loop's floating-point state (DenormalScope) and restores it.
class LoopPlayer {
 public:
  /// `start` and `original` upright, as for HapticLoop. Errors (kInput): a scene out of range, grids that
  /// differ.
  [[nodiscard]] static engine::Result<std::unique_ptr<LoopPlayer>> create(const engine::Version& start,
                                                                          const engine::Version& original,
                                                                          const Scene& scene);
  ~LoopPlayer();

  /// One tick with the input that was recorded (TickRecord::input). Its time must be what the loop measured:
  /// seconds since its first tick, to the nanosecond. Errors (kFailed): memory ran out.
  [[nodiscard]] engine::Status run(const StrokeSample& input);
  /// The same with a command first that has an answer; returns the answer.
  [[nodiscard]] engine::Result<LoopEvent> run(const StrokeSample& input, LoopCommand&& command);

  /// Ticks so far.
  [[nodiscard]] std::uint64_t ticks() const noexcept;
  /// What the last tick is heard as; null when the scene lists no sound.
  [[nodiscard]] const SoundTick* heard() const noexcept { return loop_.scene().tick.heard(); }
  /// The field after them, as felt.
  [[nodiscard]] engine::Version field() const;

 private:
  class Input;
  explicit LoopPlayer(const engine::Version& start, const engine::Version& original, const Scene& scene);

  std::shared_ptr<engine::FieldMemory> memory_;
  std::unique_ptr<Input> input_;
  LoopOptions options_;
  LoopChannels channels_;
  mutable LoopTick loop_;  // its accessor returns a mutable reference to the field
};

}  // namespace fettle::haptic
