#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "app/xr/room_screen.h"
#include "render/xr/room.h"

namespace fettle::app {

/// What a hand does to the window's frame on its screen: as a mouse does, in shares of its width and height.
struct ScreenInput {
  enum class Kind : std::uint8_t { kMove, kDown, kUp, kWheel, kLeave } kind = Kind::kMove;
  double x = 0.0, y = 0.0;
  double wheel = 0.0;  ///< steps, up = positive
};

/// Which hand does what, from frame to frame:
///
///   points   its ray meets the screen; trigger = click, thumbstick = scroll
///   carries  it squeezed while it pointed: the screen moves with it
///   holds    it squeezed elsewhere: the field moves with it (RoomTable)
///   tip      the one whose trigger was pressed last while it did not point
///
/// What began with a press goes on until it is released: a stroke that passes before the screen is no click, a slider that is
/// dragged over the screen's rim is no stroke. A hand does one thing at a time.
///
/// Threading: one thread.
class RoomHandUses {
 public:
  /// The hands of a frame, `seconds` after the last one.
  void follow(const render::RoomHands& hands, double seconds, RoomScreen& screen);

  /// What was done to the window in this frame, in order.
  [[nodiscard]] const std::vector<ScreenInput>& input() const noexcept { return input_; }
  /// The hand that points, and where.
  struct Pointing {
    std::size_t hand = 0;
    ScreenPoint point;
  };
  [[nodiscard]] const std::optional<Pointing>& pointing() const noexcept { return pointing_; }
  /// The hand that may be the tip, and whether its trigger is pressed for that.
  struct Tip {
    std::size_t hand = 0;
    bool pressed = false;
  };
  [[nodiscard]] const std::optional<Tip>& tip() const noexcept { return tip_; }
  /// Whether a hand's squeeze carries the screen, and so not the field.
  [[nodiscard]] bool carries(std::size_t hand) const noexcept {
    return hands_[hand].squeeze == Press::kOnScreen;
  }

 private:
  enum class Press : std::uint8_t { kNone, kOnScreen, kElsewhere };
  struct Hand {
    Press trigger = Press::kNone, squeeze = Press::kNone;
    std::optional<render::RoomPose> aim;  // of the last frame
  };
  void choosePointing(const render::RoomHands& hands, const RoomScreen& screen);
  void press(const render::RoomHands& hands, std::size_t i);
  void say(ScreenInput::Kind kind, double wheel = 0.0);

  std::array<Hand, 2> hands_;
  std::optional<std::size_t> last_tip_;
  std::optional<Pointing> pointing_;
  std::optional<Tip> tip_;
  ScreenInput said_;  // where the cursor was last
  bool over_ = false;
  std::vector<ScreenInput> input_;
};

}  // namespace fettle::app
