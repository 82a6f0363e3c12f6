#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include "app/work/background.h"
#include "render/live/live_picture.h"

namespace fettle::app {

/// Draws out of sight what keys may ask for next: contours, marks, deviations, another way of shading, nearer and farther
/// away. A driver compiles a shader when something is first drawn with it - on a processor that takes up to two seconds, in
/// which the window stands still - and keeps the result in its folder of compiled shaders, where every device of this machine
/// finds it. That is done once a machine, on a device of its own and behind the window (Background), in a small part of the picture.
///
/// What is then left for the window's device: making the pipelines, which that thread does as well, and loading the code, which a
/// driver does when something is drawn: 20 to 80 ms for a key, and more where a filter fills memory meanwhile. So the same is drawn
/// once more with the window's own programs (LivePicture::createBeside), a scene at a time while nothing else is to be drawn.
///
/// What fails here is tried again when it is drawn, and reported then. Threading: main.
class PictureRehearsal {
 public:
  /// `look`: a frame of what is `shown` by `window`, which lives until end(). What was begun before is given up.
  void begin(render::LivePicture& window, render::Shown shown, const render::FrameInput& look);
  /// Draws the next scene of what is `shown` now with the window's programs, 5 to 130 ms, when those behind the window are done; for
  /// a time in which nobody waits for the window.
  void drawNext(const render::Shown& shown);
  /// Keeps no version of the field until the next scene.
  void release() noexcept { beside_.reset(); }
  /// Whether drawNext() has something to draw.
  [[nodiscard]] bool drawsNext() const noexcept {
    return !left_.empty() && stage_->done.load(std::memory_order_relaxed);
  }
  /// The window's picture is not used any more: waits for the one thing that is being made for it.
  void end() noexcept;
  /// Whether all that was begun is drawn, or could not be.
  [[nodiscard]] bool done() const noexcept {
    return left_.empty() && stage_->done.load(std::memory_order_relaxed);
  }

 private:
  struct Nothing {};
  // What a rehearsal and the window share.
  struct Stage {
    std::mutex mutex;
    render::LivePicture* window = nullptr;  // under `mutex`; null: gone
    std::atomic<bool> done{false};
  };
  // At its end all is drawn, or could not be: also without memory.
  class Done {
   public:
    Done(Stage& stage, const engine::JobControl& job) noexcept : stage_(stage), job_(job) {}
    ~Done() {
      if (!job_.cancelled()) stage_.done.store(true, std::memory_order_relaxed);
    }
    Done& operator=(Done&&) = delete;

   private:
    Stage& stage_;
    const engine::JobControl& job_;
  };
  static void prepare(Stage& stage, const render::LivePicture& rehearsed);

  // How what is shown is drawn.
  struct Scene {
    render::FrameInput input;
    bool deviation = false;
    bool without_marks = false;

    [[nodiscard]] render::Shown of(render::Shown shown) const;
  };
  static std::vector<Scene> scenesOf(const render::Shown& shown, const render::FrameInput& look);

  render::LivePicture* window_ = nullptr;  // until end()
  std::vector<Scene> left_;                // for drawNext(), the next one last
  std::size_t versions_ = 0;               // for which they are
  std::unique_ptr<render::LivePicture> beside_;
  std::shared_ptr<Stage> stage_ = std::make_shared<Stage>();
  Background<Nothing> work_;
};

}  // namespace fettle::app
