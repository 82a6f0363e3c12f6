#pragma once

#include <cstdint>
#include <utility>

#include "engine/field/sample_rect.h"

namespace fettle::haptic {

/// The stroke that the loop is in: where it wrote, and when it ends. Loop thread; every call in constant time.
class RunningStroke {
 public:
  /// A tick that edited `rect`. True: a stroke begins with it.
  bool edited(const engine::SampleRect& rect) noexcept {
    rect_ = rect_.joined(rect);
    ticks_without_edit_ = 0;
    return !std::exchange(running_, true);
  }

  /// A tick that edited nothing. The stroke ends when no tool is switched on, or after `gap_ticks` such ticks.
  void rested(bool tool_off, std::uint32_t gap_ticks) noexcept {
    ++ticks_without_edit_;
    if (tool_off || ticks_without_edit_ >= gap_ticks) end();
  }

  void end() noexcept { ended_ |= std::exchange(running_, false); }
  /// The stroke is part of a state that was replaced.
  void reset() noexcept { *this = {}; }

  [[nodiscard]] bool running() const noexcept { return running_; }
  /// Whether a stroke has ended that takeEnded() has not returned yet.
  [[nodiscard]] bool hasEnded() const noexcept { return ended_; }
  /// The samples written since the last call [samples]: of the ended stroke, and of one that began since.
  engine::SampleRect takeEnded() noexcept {
    ended_ = false;
    return std::exchange(rect_, {});
  }

 private:
  engine::SampleRect rect_;
  bool running_ = false;
  bool ended_ = false;
  std::uint32_t ticks_without_edit_ = 0;
};

}  // namespace fettle::haptic
