#pragma once

#include <chrono>
#include <cmath>

namespace fettle::app {

/// The last press in a list or a menu. The first press of a double click chooses an entry and closes the list; the second
/// one is not meant for what the list covered. Threading: main.
class ListPress {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr Clock::duration kAgain = std::chrono::milliseconds(500);  ///< as the panels' double click
  static constexpr double kNear_px = 6.0;

  /// Whether a press outside of lists repeats one in a list that is closed since.
  [[nodiscard]] bool repeats(double x, double y, Clock::time_point now) const noexcept {
    return listed_ && now - at_ < kAgain && std::hypot(x - x_, y - y_) <= kNear_px;
  }
  /// A press; what is returned is repeats(). A third one repeats the second.
  bool press(double x, double y, bool in_list, Clock::time_point now) noexcept {
    const bool again = !in_list && repeats(x, y, now);
    listed_ = in_list || again;
    x_ = x;
    y_ = y;
    at_ = now;
    return again;
  }

 private:
  bool listed_ = false;
  double x_ = 0.0, y_ = 0.0;
  Clock::time_point at_;
};

}  // namespace fettle::app
