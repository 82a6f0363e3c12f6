#pragma once

#include <chrono>

namespace fettle::app {

/// When the picture is drawn with four rays per pixel (render::Sharpness::kRest): once nothing of the surface has been drawn
/// again for kQuiet. A stroke and a moving view so cost what they cost without it.
///
///   whole --- nothing drawn again for kQuiet --> band by band, a frame each --> complete
///     ^------------------------- the surface changes --------------------------'
class PictureAtRest {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kQuiet{400};

  /// Whether a frame drawn now is one at rest.
  [[nodiscard]] bool rests(Clock::time_point now) const noexcept { return now - changed_ >= kQuiet; }
  /// Whether a frame must be drawn now.
  [[nodiscard]] bool due(Clock::time_point now) const noexcept { return !complete_ && rests(now); }
  /// Whether some frame is left.
  [[nodiscard]] bool pending() const noexcept { return !complete_; }

  /// The result of a frame.
  struct Drawn {
    bool changed = false;     ///< some of the surface was drawn again
    bool at_rest = false;     ///< it was one at rest
    int left = 0;             ///< of one at rest: FrameStatistics::rest_left
    bool asked_here = false;  ///< nothing but due() asked for it
  };
  void drawn(const Drawn& frame, Clock::time_point now) noexcept {
    if (frame.changed) changed_ = now;
    // Where there is no such picture - for two eyes - or frames cannot go on from each other, it must not ask for ever.
    if (frame.at_rest && frame.asked_here && frame.changed)
      complete_ = true;
    else if (frame.at_rest)
      complete_ = frame.left == 0;
    else if (frame.changed)
      complete_ = false;
  }

 private:
  bool complete_ = false;
  Clock::time_point changed_{};
};

}  // namespace fettle::app
