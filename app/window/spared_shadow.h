#pragma once

#include <chrono>

namespace fettle::app {

/// When the pen has no shadow although it is wanted: in frames that take long, while it moves. Once it rests, one frame more is
/// drawn, with its shadow.
///
/// Deterministic: a sequence of calls gives a sequence of answers. Threading: main.
class SparedShadow {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kQuiet{250};

  /// The pen is elsewhere than in the last frame.
  void moved(Clock::time_point now) noexcept { moved_ = now; }
  /// Whether a frame drawn now has the shadow; `spares`: what costs most is to be left out.
  [[nodiscard]] bool shown(bool spares, Clock::time_point now) const noexcept {
    return !spares || now - moved_ >= kQuiet;
  }
  /// A frame was drawn; `left_out`: without a shadow that is wanted.
  void drawn(bool left_out) noexcept { left_out_ = left_out; }
  /// Whether the picture still lacks it.
  [[nodiscard]] bool pending() const noexcept { return left_out_; }
  /// Whether a frame must be drawn for its sake.
  [[nodiscard]] bool due(bool spares, Clock::time_point now) const noexcept {
    return left_out_ && shown(spares, now);
  }

 private:
  bool left_out_ = false;
  Clock::time_point moved_{};
};

}  // namespace fettle::app
