#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "app/xr/headset_exchange.h"
#include "app/xr/headset_frames.h"
#include "engine/base/error.h"

namespace fettle::app {

/// The field in a headset, beside the window: a thread of its own (HeadsetFrames), which waits for the headset's clock, so that
/// neither the window waits for the headset nor the headset for the window, and that the loss of one is none of the other.
///
/// A runtime may keep any call for as long as it likes; xrWaitFrame has no limit at all. So nothing here waits for the thread without
/// one: where it does not come back, it is left there (thread_left.h), with all that it uses.
///
/// Threading: main.
class HeadsetView {
 public:
  struct Options {
    HeadsetViewOptions frames;
    /// Called by the headset's thread where the window has something to take in or to show.
    std::function<void()> wake;
    /// A runtime that is not running yet is started by it.
    std::chrono::milliseconds starts_within = std::chrono::seconds(60);
  };
  /// Errors: Headset::create; the runtime does not answer.
  [[nodiscard]] static engine::Result<std::unique_ptr<HeadsetView>> start(Options options);
  ~HeadsetView();
  HeadsetView& operator=(HeadsetView&&) = delete;

  /// From the headset's next frame on.
  void show(HeadsetPicture picture) { exchange_->show(std::move(picture)); }
  /// The window's frame, for the screen in the room.
  void showWindow(render::Image frame) { exchange_->showWindow(std::move(frame)); }
  /// What the hands did on that screen since the last call. Where frames stay away, they let go of what they hold there.
  [[nodiscard]] std::vector<ScreenInput> takeInput();
  [[nodiscard]] HeadsetState state() const { return exchange_->state(); }
  /// Whether frames stay away, as where the runtime does not answer.
  [[nodiscard]] bool stands() const;
  /// Ends the session in the runtime's own order, and waits for that, for three seconds at most. False: the runtime did not
  /// answer, and its thread was left.
  bool finish();

 private:
  HeadsetView(std::shared_ptr<HeadsetExchange> exchange, std::thread thread)
      : exchange_(std::move(exchange)), thread_(std::move(thread)) {}

  std::shared_ptr<HeadsetExchange> exchange_;
  std::thread thread_;
  ScreenInput last_;                  // taken
  bool held_ = false, over_ = false;  // on the screen, as of it
};

}  // namespace fettle::app
