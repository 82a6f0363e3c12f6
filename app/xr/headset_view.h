#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/xr/room_hands.h"
#include "app/xr/room_screen.h"
#include "app/xr/room_table.h"
#include "app/xr/room_tip.h"
#include "engine/base/error.h"
#include "render/live/live_picture.h"
#include "render/xr/headset.h"

namespace fettle::app {

/// The field in a headset, beside the window: a thread of its own, which waits for the headset's clock, with a device and a
/// copy of the field of its own, so that neither the window waits for the headset nor the headset for the window, and that
/// the loss of one is none of the other. The controllers hold the field, are the tip on it, and point at the window's frame, which
/// hangs in the room.
///
/// Threading: main; what it exchanges with its thread is guarded.
class HeadsetView {
 public:
  struct Options {
    render::HeadsetOptions headset;
    RoomScale scale = RoomScale::kGiant;
    std::shared_ptr<haptic::ControllerLink> tip;  ///< null: another device is the tip
    /// Called by the headset's thread where the window has something to take in or to show.
    std::function<void()> wake;
  };
  /// Errors: Headset::create.
  [[nodiscard]] static engine::Result<std::unique_ptr<HeadsetView>> start(Options options);
  ~HeadsetView();
  HeadsetView& operator=(HeadsetView&&) = delete;

  /// What the headset shows from its next frame on. `field`: where it differs from the last one, the field is placed on the table again.
  struct Picture {
    render::Shown shown;
    render::FrameInput input;
    std::uint64_t field = 0;
    TipLook tip;
    std::uint64_t reader = 0;  ///< who reads the tip on this field: ControllerLink::reader
  };
  void show(Picture picture);
  /// The window's frame, for the screen in the room.
  void showWindow(render::Image frame);
  /// What the hands did on that screen since the last call.
  [[nodiscard]] std::vector<ScreenInput> takeInput();

  struct State {
    std::string headset;       ///< its name
    std::uint64_t frames = 0;  ///< drawn
    bool over = false;         ///< the session was ended, by its user or by an error
    RoomScale scale = RoomScale::kGiant;
    double metres_per_mm = 0.0;      ///< 0: the field is not placed yet
    std::optional<std::size_t> tip;  ///< the hand that is the tip
    bool points = false;             ///< a hand at the screen
    std::optional<engine::Error> error;
    std::vector<std::string> validation;  ///< of Vulkan's layers, once it is over
  };
  [[nodiscard]] State state() const;
  /// Ends the session in the runtime's own order, for two seconds at most, and waits for that; longer where the runtime does not
  /// come back from its wait for a frame, which has no limit.
  void finish();

 private:
  HeadsetView(std::unique_ptr<render::Headset> headset, std::unique_ptr<render::LivePicture> picture,
              Options options);
  void run(const std::stop_token& stop);
  [[nodiscard]] engine::Status takePicture();
  [[nodiscard]] engine::Status takeWindow();
  void follow(const render::RoomHands& hands);
  [[nodiscard]] engine::Status draw(render::LiveTarget& target);
  [[nodiscard]] std::vector<render::RoomPanel> panels() const;
  void note();

  // Of the thread, once it runs.
  std::unique_ptr<render::Headset> headset_;
  std::unique_ptr<render::LivePicture> picture_;
  std::function<void()> wake_;
  RoomTable table_;
  RoomScreen screen_;
  RoomHandUses uses_;
  RoomTip tip_;
  render::RoomHands hands_;  // of this frame
  render::Framing framing_;  // of the last picture drawn
  glm::dvec3 head_m_{0.0};
  std::chrono::steady_clock::time_point last_frame_;
  Picture now_;
  bool has_picture_ = false;
  bool ending_ = false;
  bool screen_shown_ = false;

  mutable std::mutex mutex_;
  std::optional<Picture> next_;  // guarded, as all below
  std::optional<render::Image> next_window_;
  std::vector<ScreenInput> input_;
  State state_;
  std::jthread thread_;
};

}  // namespace fettle::app
