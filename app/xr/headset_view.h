#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/xr/room_table.h"
#include "engine/base/error.h"
#include "render/live/live_picture.h"
#include "render/xr/headset.h"

namespace fettle::app {

/// The field in a headset, beside the window: a thread of its own, which waits for the headset's clock, with a device and a
/// copy of the field of its own, so that neither the window waits for the headset nor the headset for the window, and that
/// the loss of one is none of the other.
///
/// Threading: main; what it exchanges with its thread is guarded.
class HeadsetView {
 public:
  /// Errors: Headset::create.
  [[nodiscard]] static engine::Result<std::unique_ptr<HeadsetView>> start(
      const render::HeadsetOptions& options, RoomScale scale);
  ~HeadsetView();
  HeadsetView& operator=(HeadsetView&&) = delete;

  /// What the headset shows from its next frame on. `field`: where it differs from the last one, the field is placed on the table again.
  struct Picture {
    render::Shown shown;
    render::FrameInput input;
    std::uint64_t field = 0;
  };
  void show(Picture picture);

  struct State {
    std::string headset;       ///< its name
    std::uint64_t frames = 0;  ///< drawn
    bool over = false;         ///< the session was ended, by its user or by an error
    std::optional<engine::Error> error;
    std::vector<std::string> validation;  ///< of Vulkan's layers, once it is over
  };
  [[nodiscard]] State state() const;
  /// Ends the session in the runtime's own order, for two seconds at most, and waits for that.
  void finish();

 private:
  HeadsetView(std::unique_ptr<render::Headset> headset, std::unique_ptr<render::LivePicture> picture,
              RoomScale scale);
  void run(const std::stop_token& stop);
  [[nodiscard]] engine::Status takePicture();
  [[nodiscard]] engine::Status draw(render::LiveTarget& target);

  // Of the thread, once it runs.
  std::unique_ptr<render::Headset> headset_;
  std::unique_ptr<render::LivePicture> picture_;
  RoomTable table_;
  Picture now_;
  bool has_picture_ = false;

  mutable std::mutex mutex_;
  std::optional<Picture> next_;  // guarded
  State state_;                  // guarded
  std::jthread thread_;
};

}  // namespace fettle::app
