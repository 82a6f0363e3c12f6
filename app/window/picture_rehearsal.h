#pragma once

#include <atomic>
#include <memory>
#include <mutex>

#include "app/work/background.h"
#include "render/live/live_picture.h"

namespace fettle::app {

/// Draws out of sight what keys may ask for next: contours, marks, deviations, another way of shading, nearer and farther
/// away. A driver compiles a shader when something is first drawn with it - on a processor that takes up to two seconds, in
/// which the window stands still - and keeps the result in its folder of compiled shaders, where every device of this machine
/// finds it. That is done once a machine; what is then left for each device, some tens of milliseconds for each kind of
/// picture, is done for the window's, too.
///
/// On a device of its own and behind the window (Background), in a small part of the picture. What fails here is tried again
/// when it is drawn, and reported then. Threading: main.
class PictureRehearsal {
 public:
  /// `look`: a frame of what is `shown` by `window`, which lives until end(). What was begun before is given up.
  void begin(render::LivePicture& window, render::Shown shown, render::FrameInput look);
  /// The window's picture is not used any more: waits for the one thing that is being made for it.
  void end() noexcept;
  /// Whether all that was begun is drawn, or could not be.
  [[nodiscard]] bool done() const noexcept { return stage_->done.load(std::memory_order_relaxed); }

 private:
  struct Nothing {};
  // What a rehearsal and the window share.
  struct Stage {
    std::mutex mutex;
    render::LivePicture* window = nullptr;  // under `mutex`; null: gone
    std::atomic<bool> done{false};
  };
  static void prepare(Stage& stage, const render::LivePicture& rehearsed);

  std::shared_ptr<Stage> stage_ = std::make_shared<Stage>();
  Background<Nothing> work_;
};

}  // namespace fettle::app
