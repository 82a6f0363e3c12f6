#pragma once

#include <chrono>

namespace fettle::app {

/// How high the place of the notices under the panels is. Where a person has just pressed on what a notice would cover, or moves the
/// pointer over it, it stays as it is until the hand rests or goes elsewhere: the next press is meant for what lies there now.
/// Threading: main.
class NoticeRoom {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr Clock::duration kAfterPress = std::chrono::seconds(1);
  /// A pointer that has lain still for so long reaches for nothing.
  static constexpr Clock::duration kAfterMove = std::chrono::seconds(3);

  /// A button is down in the panels, so far above their lower end [pixels].
  void press(float above, Clock::time_point now) noexcept {
    pressed_above_ = above;
    pressed_at_ = now;
  }
  /// The pointer is so far above the lower end of the panels [pixels], or elsewhere: below 0. `x`: where across.
  void point(float above, float x, Clock::time_point now) noexcept {
    if (above == pointed_above_ && x == pointed_x_) return;
    pointed_above_ = above;
    pointed_x_ = x;
    pointed_at_ = now;
  }
  /// The height for this frame, of `wanted` for all notices [pixels].
  [[nodiscard]] float follow(float wanted, Clock::time_point now) noexcept {
    const auto covers = [&](float above) { return above > height_ && above <= wanted; };
    waits_ = (covers(pressed_above_) && now - pressed_at_ < kAfterPress) ||
             (covers(pointed_above_) && now - pointed_at_ < kAfterMove);
    if (!waits_) height_ = wanted;
    return height_;
  }
  /// Whether notices wait for the hand.
  [[nodiscard]] bool waits() const noexcept { return waits_; }

 private:
  float height_ = 0.0F;
  bool waits_ = false;
  float pressed_above_ = -1.0F;  // nowhere
  Clock::time_point pressed_at_;
  float pointed_above_ = -1.0F, pointed_x_ = -1.0F;
  Clock::time_point pointed_at_;
};

}  // namespace fettle::app
