#pragma once

#include <algorithm>

#include <glm/glm.hpp>

#include "haptic/base/force.h"
#include "haptic/devices/device.h"

namespace fettle::haptic {

/// The newest input of a device and the hand's velocity there. Loop thread; constant time.
class InputMotion {
 public:
  /// An input, new or the same as before.
  void note(const DeviceInput& input) noexcept {
    if (has_input_ && input.sequence == last_.sequence) return;
    velocity_ = glm::dvec3(0.0);
    if (has_input_ && placed(input) && placed(last_)) {
      const double since_s = 1e-9 * static_cast<double>(input.arrival_ns - last_.arrival_ns);
      velocity_ = (input.position_mm - last_.position_mm) / std::max(since_s, kShortest_s);
    }
    last_ = input;
    has_input_ = true;
  }
  [[nodiscard]] const glm::dvec3& position() const noexcept { return last_.position_mm; }  ///< [mm]
  [[nodiscard]] const glm::dvec3& velocity() const noexcept { return velocity_; }          ///< [mm/s]

 private:
  // Inputs that arrive in a burst must not give a wrong speed.
  static constexpr double kShortest_s = 0.0005;

  // A stylus that was lifted off has no position, and its next position is not a movement.
  static bool placed(const DeviceInput& input) noexcept {
    return input.link == LinkState::kConnected && finite(input.position_mm);
  }

  DeviceInput last_;
  bool has_input_ = false;
  glm::dvec3 velocity_{0.0};
};

}  // namespace fettle::haptic
