#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include <glm/vec3.hpp>

#include "haptic/devices/device.h"

namespace fettle::app {

/// The box in which a stylus was moved, in the device's own frame [mm].
struct DeviceReach {
  glm::dvec3 low_mm{0.0};
  glm::dvec3 high_mm{0.0};

  [[nodiscard]] glm::dvec3 middle() const noexcept { return 0.5 * (low_mm + high_mm); }
  [[nodiscard]] glm::dvec3 extent() const noexcept { return high_mm - low_mm; }
  /// Of the ball about the middle that is within it [mm].
  [[nodiscard]] double radius() const noexcept {
    const glm::dvec3 e = extent();
    return 0.5 * std::min({e.x, e.y, e.z});
  }
  friend bool operator==(const DeviceReach&, const DeviceReach&) = default;
};

/// How one device is used, by what was measured of it and as its user wants it.
struct DeviceSetup {
  static constexpr double kLeastMotion = 0.1;

  std::optional<DeviceReach> reach;  ///< nothing: that of its profile
  /// Motion of the tip, as a share of the largest one that is stable and reaches all of the field: kLeastMotion .. 1. Less is finer, and
  /// softer.
  double motion = 1.0;
  std::uint32_t clutch_buttons = haptic::kSecondaryButton;  ///< haptic::LoopOptions::clutch_buttons

  /// The profile with the measured reach.
  [[nodiscard]] haptic::DeviceProfile in(haptic::DeviceProfile profile) const {
    if (reach) profile.workspace_radius_mm = reach->radius();
    return profile;
  }
  std::uint32_t menu_buttons = 0;  ///< haptic::LoopOptions::menu_buttons: of the tools around the tip

  /// What a button is given to has it alone.
  void giveClutch(std::uint32_t buttons) noexcept {
    clutch_buttons = buttons;
    menu_buttons &= ~buttons;
  }
  void giveMenu(std::uint32_t buttons) noexcept {
    menu_buttons = buttons;
    clutch_buttons &= ~buttons;
  }

  friend bool operator==(const DeviceSetup&, const DeviceSetup&) = default;
};

/// By setupKey().
using DeviceSetups = std::map<std::string, DeviceSetup>;

/// What tells one device from others: its kind and its serial number. Devices of one kind that state no number share a setup.
[[nodiscard]] inline std::string setupKey(const haptic::DeviceProfile& profile) {
  return profile.serial.empty() ? profile.name : profile.name + ", " + profile.serial;
}

}  // namespace fettle::app
