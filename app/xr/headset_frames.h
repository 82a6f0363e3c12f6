#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/xr/headset_exchange.h"
#include "app/xr/room_hands.h"
#include "app/xr/room_screen.h"
#include "app/xr/room_table.h"
#include "app/xr/room_tip.h"
#include "engine/base/error.h"
#include "render/live/live_picture.h"
#include "render/xr/headset.h"

namespace fettle::app {

struct HeadsetViewOptions {
  render::HeadsetOptions headset;
  RoomScale scale = RoomScale::kGiant;
  std::shared_ptr<haptic::ControllerLink> tip;  ///< null: another device is the tip
};

/// A headset's frames, one after the other: the field with a device and a copy of its own, the window's frame as a screen in
/// the room, and the hands, which hold the field, are the tip on it, and point at that screen.
///
/// Threading: the headset's thread, from create() on.
class HeadsetFrames {
 public:
  /// A runtime that does not end the session when asked has this long.
  static constexpr std::chrono::seconds kLongestEnd{2};

  /// Errors: Headset::create.
  [[nodiscard]] static engine::Result<std::unique_ptr<HeadsetFrames>> create(
      const HeadsetViewOptions& options, std::shared_ptr<HeadsetExchange> exchange);
  HeadsetFrames& operator=(HeadsetFrames&&) = delete;

  [[nodiscard]] const std::string& name() const { return headset_->name(); }
  /// Until the session has ended, or has had its time for that after HeadsetExchange::stop; then the runtime is left, too.
  void run();

 private:
  HeadsetFrames(std::unique_ptr<render::Headset> headset, std::unique_ptr<render::LivePicture> picture,
                const HeadsetViewOptions& options, std::shared_ptr<HeadsetExchange> exchange);
  [[nodiscard]] engine::Status frame();
  void beginEnd();
  [[nodiscard]] engine::Status takePicture();
  [[nodiscard]] engine::Status takeWindow();
  void follow(const render::RoomHands& hands);
  [[nodiscard]] engine::Status draw(render::LiveTarget& target);
  [[nodiscard]] std::vector<render::RoomPanel> panels() const;
  void note();

  std::unique_ptr<render::Headset> headset_;
  std::unique_ptr<render::LivePicture> picture_;
  std::shared_ptr<HeadsetExchange> exchange_;
  RoomTable table_;
  RoomScreen screen_;
  RoomHandUses uses_;
  RoomTip tip_;
  render::RoomHands hands_;  // of this frame
  render::Framing framing_;  // of the last picture drawn
  glm::dvec3 head_m_{0.0};
  HeadsetExchange::Clock::time_point last_frame_ = HeadsetExchange::Clock::now();
  HeadsetPicture now_;
  bool has_picture_ = false;
  bool screen_shown_ = false;
  std::optional<HeadsetExchange::Clock::time_point> ends_by_;  // it was asked to end
  HeadsetState state_;
};

}  // namespace fettle::app
