#pragma once

#include <vector>

#include "app/work/loop_client.h"
#include "render/live/live_picture.h"

namespace fettle::app {

/// The stylus in the picture: tip, force, and the ring of the brush; and the force of the last frames.
/// Threading: main.
class StylusOverlay {
 public:
  /// Whether the drawn position differs from the actual one by more than a pixel.
  [[nodiscard]] bool moved(const haptic::LoopState& state, double mm_per_pixel) const;
  /// Adds it to the overlays of the next frame.
  static void append(const LoopClient& client, const haptic::LoopState& state, double mm_per_pixel,
                     render::Overlays& overlays);
  /// The next frame shows this state, and `drawn`: it was drawn.
  void begin(const haptic::LoopState& state) { state_ = state; }
  void drawn();

  [[nodiscard]] const haptic::LoopState& state() const noexcept { return state_; }
  /// Of the last frames [N], oldest first.
  [[nodiscard]] const std::vector<float>& forces() const noexcept { return forces_; }

 private:
  haptic::LoopState state_;
  std::vector<float> forces_;
};

}  // namespace fettle::app
