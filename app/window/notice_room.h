#pragma once

#include <chrono>

namespace fettle::app {

/// How high the place of the notices under the panels is. Where a person has just pressed on what a notice would cover it
/// stays as it is for a moment: the next press is meant for what lies there now. Threading: main.
class NoticeRoom {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr Clock::duration kAfterPress = std::chrono::seconds(1);

  /// A button is down in the panels, so far above their lower end [pixels].
  void press(float above, Clock::time_point now) noexcept {
    pressed_above_ = above;
    pressed_at_ = now;
  }
  /// The height for this frame, of `wanted` for all notices [pixels].
  [[nodiscard]] float follow(float wanted, Clock::time_point now) noexcept {
    const bool covers = pressed_above_ > height_ && pressed_above_ <= wanted;
    waits_ = covers && now - pressed_at_ < kAfterPress;
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
};

}  // namespace fettle::app
