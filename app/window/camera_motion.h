#pragma once

#include <chrono>
#include <optional>

#include "render/live/live_picture.h"

namespace fettle::app {

/// When the picture is drawn at half resolution: while the view moves, to keep the frame rate. The full
/// resolution follows when the view is at rest: after two frames of a 60 Hz display, or, while a button is
/// still held and the movement may continue, after a tenth of a second.
class CameraMotion {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kRest{33}, kRestHeld{100};

  /// The resolution of a frame of this view, drawn now. The first one is sharp.
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
  /// Whether the last frame was not sharp: another frame must follow in any case.
  [[nodiscard]] bool sharpPending() const noexcept { return sharp_pending_; }

 private:
  std::optional<render::View> seen_;
  Clock::time_point moved_;
  bool sharp_pending_ = false;
};

}  // namespace fettle::app
