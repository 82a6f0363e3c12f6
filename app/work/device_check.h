#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "app/work/device_setup.h"
#include "haptic/loop/messages.h"

namespace fettle::app {

/// A way in which the person is asked to push the stylus, in the order of the axes of haptic::DeviceSpace::kDesk.
enum class PushedWay : std::uint8_t { kRight, kAway, kUp, kCount };
inline constexpr int kPushedWays = static_cast<int>(PushedWay::kCount);

/// What is measured of a device while a person moves it, without force: how far it reaches, whether it is at rest, which axis
/// answers to which way. One measurement at a time; each keeps its last result. Threading: main.
class DeviceCheck {
 public:
  enum class Running : std::uint8_t { kNothing, kReach, kRest, kDirection };

  static constexpr double kLeastReach_mm = 20.0;  ///< of each axis: less is a device that was hardly moved
  static constexpr double kPush_mm = 15.0;        ///< that make a push
  static constexpr std::int64_t kRest_ns = 2'000'000'000;

  /// As if nothing had been measured.
  void forget() { *this = {}; }
  /// Begins, without the result that there was. What ran ends as it is.
  void beginReach();
  void beginRest();
  void beginDirection(PushedWay way);
  void stop() noexcept { running_ = Running::kNothing; }

  /// The newest tick. A device that is not connected, or not calibrated, adds nothing.
  void note(const haptic::LoopState& state);

  [[nodiscard]] Running running() const noexcept { return running_; }
  [[nodiscard]] PushedWay asked() const noexcept { return asked_; }  ///< while a direction is measured
  /// Of the rest, in 0 .. 1.
  [[nodiscard]] double restDone() const noexcept;

  /// Seen so far.
  [[nodiscard]] const std::optional<DeviceReach>& reach() const noexcept { return reach_; }
  /// Whether each axis was moved far enough for its result to be used.
  [[nodiscard]] bool reachIsUsable() const noexcept;

  struct Rest {
    double force_n = 0.0;             ///< largest that was sent to the device
    double moved_mm = 0.0;            ///< between the farthest positions along an axis
    std::uint64_t device_faults = 0;  ///< that the guard found meanwhile
  };
  /// Of the last rest that came to its end.
  [[nodiscard]] const std::optional<Rest>& rest() const noexcept { return rest_; }

  struct Direction {
    int axis = 0;  ///< of the device's positions
    int sign = 1;
    double moved_mm = 0.0;
    friend bool operator==(const Direction&, const Direction&) = default;
  };
  [[nodiscard]] const std::optional<Direction>& direction(PushedWay way) const noexcept {
    return directions_[static_cast<std::size_t>(way)];
  }
  /// Whether the axis that answered is the way's own, with its sign.
  [[nodiscard]] static bool asExpected(PushedWay way, const Direction& came) noexcept {
    return came.axis == static_cast<int>(way) && came.sign > 0;
  }

 private:
  void noteRest(const haptic::LoopState& state);
  void noteDirection(const haptic::LoopState& state);

  Running running_ = Running::kNothing;
  PushedWay asked_ = PushedWay::kRight;
  std::optional<haptic::LoopState> first_;  // of the measurement that runs
  std::int64_t now_ns_ = 0;
  DeviceReach held_;  // positions during a rest
  Rest resting_;
  std::optional<DeviceReach> reach_;
  std::optional<Rest> rest_;
  std::array<std::optional<Direction>, kPushedWays> directions_;
};

/// "right", "away", "up".
[[nodiscard]] const char* name(PushedWay way) noexcept;
/// "+x", "-z".
[[nodiscard]] std::string axisText(const DeviceCheck::Direction& direction);

}  // namespace fettle::app
