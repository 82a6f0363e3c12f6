#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "app/work/background.h"
#include "render/live/live_picture.h"

namespace fettle::app {

/// Draws out of sight what keys may ask for next: contours, marks, deviations, another way of shading, nearer and farther
/// away. A driver compiles a shader when something is first drawn with it - on a processor that takes up to two seconds, in
/// which the window stands still - and keeps the result in its folder of compiled shaders, where every device of this machine
/// finds it. So this is done once a machine; afterwards it takes a fraction of a second of the processor.
///
/// On a device of its own and behind the window (Background), in a small part of the picture. What fails here is tried again
/// when it is drawn, and reported then. Threading: main.
class PictureRehearsal {
 public:
  /// `device`: the window's, by its name. `look`: a frame of what is shown. What was begun before is given up.
  void begin(std::string device, render::Shown shown, render::FrameInput look);
  /// Whether all that was begun is drawn, or could not be.
  [[nodiscard]] bool done() const noexcept { return done_->load(std::memory_order_relaxed); }

 private:
  struct Nothing {};
  std::shared_ptr<std::atomic<bool>> done_ = std::make_shared<std::atomic<bool>>(false);
  Background<Nothing> work_;
};

}  // namespace fettle::app
