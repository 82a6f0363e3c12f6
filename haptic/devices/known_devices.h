#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "haptic/devices/device.h"

namespace fettle::haptic {

/// Published limits of known force devices (CHAI3D's device table; for the WoodenHaptics the makers'
/// configurations), for drivers of them and for users' profiles.
struct KnownDevice {
  std::string_view name;
  double workspace_radius_mm;  ///< half of the smallest side where the workspace is no ball
  double max_force_n;
  double max_stiffness_n_per_mm;
  double max_damping_n_s_per_mm;
};

[[nodiscard]] std::span<const KnownDevice> knownDevices() noexcept;

/// Profile by name; nothing for an unknown one, whose limits are the defaults of DeviceProfile.
[[nodiscard]] std::optional<DeviceProfile> knownProfile(std::string_view name);

}  // namespace fettle::haptic
