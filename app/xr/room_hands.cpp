#include "app/xr/room_hands.h"

#include <algorithm>
#include <cmath>

namespace fettle::app {
namespace {

// A press begins above the one and ends below the other, so that a finger at rest between them does neither.
constexpr double kPressed = 0.5, kReleased = 0.35;
// Of a thumbstick: a rest in its middle, and steps of a wheel per second at its end.
constexpr double kStickRests = 0.2, kStepsPerSecond = 10.0;
constexpr double kLongestFrame_s = 0.1;

}  // namespace

void RoomHandUses::say(ScreenInput::Kind kind, double wheel) {
  input_.push_back({kind, said_.x, said_.y, wheel});
}

void RoomHandUses::choosePointing(const render::RoomHands& hands, const RoomScreen& screen) {
  const std::optional<Pointing> before = pointing_;
  pointing_.reset();
  const auto look = [&](std::size_t i) {
    if (pointing_ || !hands[i].tracked) return;
    const Hand& hand = hands_[i];
    if (hand.trigger == Press::kElsewhere || hand.squeeze == Press::kElsewhere) return;
    // A press on the screen goes on beside it.
    const auto point =
        hand.trigger == Press::kOnScreen ? screen.beside(hands[i].aim) : screen.under(hands[i].aim);
    if (point) pointing_ = Pointing{i, *point};
  };
  for (std::size_t i = 0; i < hands.size(); ++i)
    if (hands_[i].trigger == Press::kOnScreen) look(i);
  if (before) look(before->hand);
  look(1);
  look(0);
}

// What trigger and squeeze begin and end in this frame.
void RoomHandUses::press(const render::RoomHands& hands, std::size_t i) {
  Hand& hand = hands_[i];
  const bool points = pointing_ && pointing_->hand == i;
  const auto follow = [&](double value, Press& press) {
    if (press != Press::kNone) {
      if (value < kReleased || !hands[i].tracked) press = Press::kNone;
      return false;
    }
    if (value <= kPressed || !hands[i].tracked) return false;
    press = points ? Press::kOnScreen : Press::kElsewhere;
    return true;
  };
  const bool clicked = hand.trigger == Press::kOnScreen;
  const bool began = follow(hands[i].trigger, hand.trigger);
  if (began && points) say(ScreenInput::Kind::kDown);
  if (began && !points) last_tip_ = i;
  if (clicked && hand.trigger == Press::kNone) say(ScreenInput::Kind::kUp);
  follow(hands[i].squeeze, hand.squeeze);
}

void RoomHandUses::follow(const render::RoomHands& hands, double seconds, RoomScreen& screen) {
  input_.clear();
  for (std::size_t i = 0; i < hands.size(); ++i)
    if (carries(i) && hands[i].tracked && hands_[i].aim) screen.carry(*hands_[i].aim, hands[i].aim);
  choosePointing(hands, screen);
  if (pointing_) {
    const double x = std::clamp(pointing_->point.x, 0.0, 1.0), y = std::clamp(pointing_->point.y, 0.0, 1.0);
    const bool moved = !over_ || x != said_.x || y != said_.y;
    said_.x = x;
    said_.y = y;
    if (moved) say(ScreenInput::Kind::kMove);
  }
  for (std::size_t i = 0; i < hands.size(); ++i) press(hands, i);
  if (pointing_) {
    const double stick = hands[pointing_->hand].scroll;
    if (std::abs(stick) > kStickRests)
      say(ScreenInput::Kind::kWheel, stick * kStepsPerSecond * std::clamp(seconds, 0.0, kLongestFrame_s));
  } else if (over_) {
    say(ScreenInput::Kind::kLeave);
  }
  over_ = pointing_.has_value();

  tip_.reset();
  if (last_tip_) {
    const std::size_t i = *last_tip_;
    const bool points = pointing_ && pointing_->hand == i;
    if (hands[i].tracked && !points && hands_[i].squeeze == Press::kNone)
      tip_ = Tip{i, hands_[i].trigger == Press::kElsewhere};
  }
  for (std::size_t i = 0; i < hands.size(); ++i)
    hands_[i].aim = hands[i].tracked ? std::optional(hands[i].aim) : std::nullopt;
}

}  // namespace fettle::app
