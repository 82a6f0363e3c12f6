#pragma once

#include <chrono>
#include <cstdint>

namespace fettle::app {

/// When the renewal of a lost graphics device is tried again, and when it is given up. Threading: main.
class DeviceRenewal {
 public:
  using Clock = std::chrono::steady_clock;

  /// The device is lost, with so many frames shown since the start. False: too many attempts.
  [[nodiscard]] bool lost(std::uint64_t frames, Clock::time_point now);
  [[nodiscard]] bool due(Clock::time_point now) const noexcept { return now >= next_; }
  /// An attempt begins.
  void begin(std::uint64_t frames) noexcept { renewed_frame_ = frames; }
  /// Devices lost so far.
  [[nodiscard]] int losses() const noexcept { return losses_; }

 private:
  int losses_ = 0;
  int tries_ = 0;  // since the picture last worked for a while
  std::uint64_t renewed_frame_ = 0;
  Clock::time_point next_{};
};

}  // namespace fettle::app
