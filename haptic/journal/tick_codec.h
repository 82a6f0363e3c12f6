#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/error.h"
#include "haptic/base/strokes.h"

namespace fettle::haptic {

/// Packs the inputs of ticks into bytes without loss: a journal stores one for every tick.
///
/// A block can be decoded alone. Each tick is a byte that states what changed, then only the changes: the
/// time as a difference from one period after the tick before [ns, zigzag varint], positions as the doubles'
/// bits, the tool as one byte. Ticks without a usable position (x not finite: no contact possible) are
/// counted in runs of one tool, their times left out. A resting hand takes 2 to 4 bytes per tick, a moving
/// one 27.
class TickPacker {
 public:
  void add(const haptic::StrokeSample& tick);
  [[nodiscard]] std::int64_t count() const noexcept { return count_; }
  [[nodiscard]] std::size_t bytes() const noexcept { return block_.size(); }
  /// The block so far; the next tick begins another.
  [[nodiscard]] std::string take();

 private:
  void endRun();

  std::string block_;
  haptic::StrokeSample last_;
  std::int64_t last_ns_ = 0;
  std::int64_t count_ = 0;
  std::uint64_t run_ = 0;  // ticks without input, not written yet
  haptic::Tool run_tool_ = haptic::Tool::kFeel;
};

/// The ticks of a block; those without input have a NaN for x and the time of the tick before. Errors
/// (kInput): bytes that are not a block of TickPacker.
[[nodiscard]] engine::Result<std::vector<haptic::StrokeSample>> unpackTicks(std::string_view block);

}  // namespace fettle::haptic
