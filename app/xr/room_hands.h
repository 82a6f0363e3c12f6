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

/// Adds what was done to what a window has not taken yet. Cursor positions between others are left out; of a window that does not
/// answer at all, more than a thousand presses are, but never a release or the end.
void appendInput(const ScreenInput& next, std::vector<ScreenInput>& waiting);

/// Which hand does what, from frame to frame:
///
///   points   its ray meets the screen; trigger = click, thumbstick = scroll
///   carries  it squeezed while it pointed: the screen moves with it
///   holds    it squeezed elsewhere: the field moves with it (RoomTable)
///   tip      the one whose trigger was pressed last while it did not point
///
/// What began with a press goes on until it is released: a stroke that passes before the screen is no click, a slider that is
/// dragged over the screen's rim is no stroke. A hand does one thing at a time: what is pressed beside it begins nothing, also
/// not later. The tip stays with its hand while that presses. A hand that was not seen begins nothing before it has let go once,
/// so that a trigger held meanwhile is no second press.
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
    std::uint64_t press = 0;  ///< which press of a tip's trigger is the last one, counted
  };
  [[nodiscard]] const std::optional<Tip>& tip() const noexcept { return tip_; }
  /// Whether a hand's squeeze carries the screen, and so not the field.
  [[nodiscard]] bool carries(std::size_t hand) const noexcept {
    return hands_[hand].squeeze.press == Press::kOnScreen;
  }
  /// The hands as the table is to follow them (RoomTable::follow): without what is done to the screen or beside a stroke.
  [[nodiscard]] const render::RoomHands& holding() const noexcept { return holding_; }

 private:
  enum class Press : std::uint8_t { kNone, kOnScreen, kElsewhere };
  struct Control {
    Press press = Press::kNone;
    bool ready = false;  // it was let go since the hand is seen and since its last press
  };
  struct Hand {
    Control trigger, squeeze;
    bool button_ignored = false;          // it went down during a stroke
    std::optional<render::RoomPose> aim;  // of the last frame
  };
  void choosePointing(const render::RoomHands& hands, const RoomScreen& screen);
  void release(const render::RoomHand& seen, Hand& hand);
  void press(const render::RoomHand& seen, std::size_t i);
  void hold(const render::RoomHands& hands);
  void say(ScreenInput::Kind kind, double wheel = 0.0);

  std::array<Hand, 2> hands_;
  std::optional<std::size_t> last_tip_;
  std::uint64_t presses_ = 0;  // of tips
  render::RoomHands holding_;
  std::optional<Pointing> pointing_;
  std::optional<Tip> tip_;
  ScreenInput said_;  // where the cursor was last
  bool over_ = false;
  std::vector<ScreenInput> input_;
};

}  // namespace fettle::app
