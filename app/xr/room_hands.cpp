#include "app/xr/room_hands.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fettle::app {
namespace {

// A press begins above the one and ends below the other, so that a finger at rest between them does neither.
constexpr double kPressed = 0.5, kReleased = 0.35;
// Of a thumbstick: a rest in its middle, and steps of a wheel per second at its end.
constexpr double kStickRests = 0.2, kStepsPerSecond = 10.0;
constexpr double kLongestFrame_s = 0.1;
constexpr std::size_t kMostWaiting = 4096;

}  // namespace

void appendInput(const ScreenInput& next, std::vector<ScreenInput>& waiting) {
  using Kind = ScreenInput::Kind;
  if (next.kind == Kind::kMove && !waiting.empty() && waiting.back().kind == Kind::kMove)
    waiting.back() = next;
  else if (next.kind == Kind::kUp || next.kind == Kind::kLeave || waiting.size() < kMostWaiting)
    waiting.push_back(next);
}

void RoomHandUses::say(ScreenInput::Kind kind, double wheel) {
  input_.push_back({kind, said_.x, said_.y, wheel});
}

void RoomHandUses::choosePointing(const render::RoomHands& hands, const RoomScreen& screen) {
  const std::optional<Pointing> before = pointing_;
  pointing_.reset();
  const auto look = [&](std::size_t i) {
    if (pointing_ || !hands[i].tracked) return;
    const Hand& hand = hands_[i];
    if (hand.trigger.press == Press::kElsewhere || hand.squeeze.press == Press::kElsewhere) return;
    // A press on the screen goes on beside it.
    const auto point =
        hand.trigger.press == Press::kOnScreen ? screen.beside(hands[i].aim) : screen.under(hands[i].aim);
    if (point) pointing_ = Pointing{i, *point};
  };
  for (std::size_t i = 0; i < hands.size(); ++i)
    if (hands_[i].trigger.press == Press::kOnScreen) look(i);
  if (before) look(before->hand);
  look(1);
  look(0);
}

// What trigger and squeeze end in this frame.
void RoomHandUses::release(const render::RoomHand& seen, Hand& hand) {
  const auto follow = [&](double value, Control& control) {
    if (seen.tracked && value >= kReleased) return;
    control.press = Press::kNone;
    control.ready = seen.tracked;
  };
  const bool clicked = hand.trigger.press == Press::kOnScreen;
  follow(seen.trigger, hand.trigger);
  follow(seen.squeeze, hand.squeeze);
  if (clicked && hand.trigger.press == Press::kNone) say(ScreenInput::Kind::kUp);
}

// What they begin.
void RoomHandUses::press(const render::RoomHand& seen, std::size_t i) {
  Hand& hand = hands_[i];
  const bool points = pointing_ && pointing_->hand == i;
  const auto begins = [&](double value, Control& control, const Control& other) {
    if (!seen.tracked || value <= kPressed) return false;
    // What is pressed while it may not begin anything has to be pressed again.
    if (!std::exchange(control.ready, false) || other.press != Press::kNone) return false;
    control.press = points ? Press::kOnScreen : Press::kElsewhere;
    return true;
  };
  if (begins(seen.trigger, hand.trigger, hand.squeeze)) {
    if (points) {
      say(ScreenInput::Kind::kDown);
    } else if (!last_tip_ || *last_tip_ == i || hands_[*last_tip_].trigger.press != Press::kElsewhere) {
      last_tip_ = i;
      ++presses_;
    }
  }
  static_cast<void>(begins(seen.squeeze, hand.squeeze, hand.trigger));
}

// What the table is to follow: a field is held by a squeeze that began as one, and its scale stays under a tip that is pressed.
void RoomHandUses::hold(const render::RoomHands& hands) {
  holding_ = hands;
  for (std::size_t i = 0; i < hands.size(); ++i) {
    Hand& hand = hands_[i];
    if (hand.squeeze.press != Press::kElsewhere) holding_[i].squeeze = 0.0;
    hand.button_ignored = hands[i].button && (hand.button_ignored || (tip_ && tip_->pressed));
    if (hand.button_ignored) holding_[i].button = false;
  }
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
  // First all releases: a hand that lets go leaves the tip to one that presses in the same frame.
  for (std::size_t i = 0; i < hands.size(); ++i) release(hands[i], hands_[i]);
  for (std::size_t i = 0; i < hands.size(); ++i) press(hands[i], i);
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
    if (hands[i].tracked && !points && hands_[i].squeeze.press == Press::kNone)
      tip_ = Tip{i, hands_[i].trigger.press == Press::kElsewhere, presses_};
  }
  hold(hands);
  for (std::size_t i = 0; i < hands.size(); ++i)
    hands_[i].aim = hands[i].tracked ? std::optional(hands[i].aim) : std::nullopt;
}

}  // namespace fettle::app
