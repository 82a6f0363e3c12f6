#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "app/xr/room_hands.h"
#include "app/xr/room_table.h"
#include "app/xr/room_tip.h"
#include "engine/base/error.h"
#include "render/live/live_picture.h"

namespace fettle::app {

/// What a headset shows. `field`: where it differs from the last one, the field is placed on the table again.
struct HeadsetPicture {
  render::Shown shown;
  render::FrameInput input;
  std::uint64_t field = 0;
  TipLook tip;
  std::uint64_t reader = 0;  ///< who reads the tip on this field: ControllerLink::reader
};

/// As its thread noted it last.
struct HeadsetState {
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

/// Between the window and the headset's thread, either of which may be the last to hold it. Nothing is waited for with its lock
/// held, so that neither side waits for what the other one does.
///
/// Threading: any.
class HeadsetExchange {
 public:
  using Clock = std::chrono::steady_clock;
  explicit HeadsetExchange(std::function<void()> wake) : wake_(std::move(wake)) {}

  // From the window.
  void show(HeadsetPicture picture);
  void showWindow(render::Image frame);
  void stop();
  /// Nothing is woken any more.
  void leave();
  [[nodiscard]] std::vector<ScreenInput> takeInput();
  [[nodiscard]] HeadsetState state() const;
  /// When the headset's last frame came, or its thread began.
  [[nodiscard]] Clock::time_point lastFrame() const;
  /// Waits until the headset has started or not, or until the thread has ended; nothing: neither came in this time.
  [[nodiscard]] std::optional<engine::Status> waitForStart(Clock::duration longest);
  [[nodiscard]] bool waitForEnd(Clock::duration longest);

  // From the headset's thread.
  void noteStart(engine::Status started, std::string name);
  void noteFrame(Clock::time_point now);
  void note(const HeadsetState& state);
  /// Adds what hands did to the window, and wakes it.
  void give(const std::vector<ScreenInput>& input);
  void noteEnd(engine::Status status, std::vector<std::string> validation);
  [[nodiscard]] std::optional<HeadsetPicture> takePicture();
  [[nodiscard]] std::optional<render::Image> takeWindow();
  [[nodiscard]] bool stopped() const;

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::function<void()> wake_;  // guarded, as all below; empty: the window is left
  std::optional<engine::Status> started_;
  bool ended_ = false, stopped_ = false;
  Clock::time_point last_frame_ = Clock::now();
  std::optional<HeadsetPicture> next_;
  std::optional<render::Image> next_window_;
  std::vector<ScreenInput> input_;
  HeadsetState state_;
};

}  // namespace fettle::app
