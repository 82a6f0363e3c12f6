#pragma once

#include <chrono>

namespace fettle::app {

/// When a picture that was drawn with less, because whole frames take long, is drawn sharply: once nothing has changed it for
/// kQuiet.
///
///   sharp --- drawn with less --> waits --- kQuiet --> due --- drawn --> sharp
///                                 ^ drawn with less |
class SharpLater {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kQuiet{250};

  void drawnWithLess(Clock::time_point now) noexcept {
    waits_ = true;
    since_ = now;
  }
  void drawnSharply() noexcept { waits_ = false; }
  [[nodiscard]] bool pending() const noexcept { return waits_; }
  [[nodiscard]] bool due(Clock::time_point now) const noexcept { return waits_ && now - since_ >= kQuiet; }

 private:
  bool waits_ = false;
  Clock::time_point since_{};
};

}  // namespace fettle::app
