#pragma once

#include <chrono>
#include <optional>

#include "render/live/live_picture.h"

namespace fettle::app {

/// When the picture is drawn half as sharp: while the view moves, so that it follows the hand. The sharp one
/// comes as soon as the view rests: after two frames of a 60 Hz display, or, while a button still holds it
/// and the hand may go on, after a tenth of a second.
class CameraMotion {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kRest{33}, kRestHeld{100};

  /// What a frame of this view, drawn now, is to be. The first one is sharp.
  [[nodiscard]] render::Sharpness see(const render::View& view, bool held, Clock::time_point now) {
    if (seen_ && !(*seen_ == view)) {
      moved_ = now;
      sharp_pending_ = true;
    } else if (sharp_pending_ && now - moved_ >= (held ? kRestHeld : kRest)) {
      sharp_pending_ = false;
    }
    seen_ = view;
    return sharp_pending_ ? render::Sharpness::kHalf : render::Sharpness::kFull;
  }
  /// Whether the last frame seen was not sharp: another one is to come even if nothing else happens.
  [[nodiscard]] bool sharpPending() const noexcept { return sharp_pending_; }

 private:
  std::optional<render::View> seen_;
  Clock::time_point moved_;
  bool sharp_pending_ = false;
};

}  // namespace fettle::app
