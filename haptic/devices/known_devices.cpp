#include "haptic/devices/known_devices.h"

#include <algorithm>
#include <array>

namespace fettle::haptic {

constexpr std::array kDevices{
    KnownDevice{"touch", 35.0, 3.3, 0.4, 0.004},
    KnownDevice{"omni", 35.0, 3.3, 0.7, 0.005},
    KnownDevice{"phantom_desktop", 100.0, 7.9, 1.0, 0.005},
    KnownDevice{"falcon", 50.0, 8.0, 3.0, 0.020},
    KnownDevice{"omega.3", 75.0, 12.0, 5.0, 0.030},
    KnownDevice{"delta.3", 150.0, 20.0, 5.0, 0.030},
    KnownDevice{"woodenhaptics", 100.0, 5.0, 1.0, 0.008},
};

std::span<const KnownDevice> knownDevices() noexcept {
  return kDevices;
}

std::optional<DeviceProfile> knownProfile(std::string_view name) {
  const auto it =
      std::find_if(kDevices.begin(), kDevices.end(), [&](const KnownDevice& d) { return d.name == name; });
  if (it == kDevices.end()) return std::nullopt;
  DeviceProfile p;
  p.name = it->name;
  p.workspace_radius_mm = it->workspace_radius_mm;
  p.max_force_n = it->max_force_n;
  p.max_stiffness_n_per_mm = it->max_stiffness_n_per_mm;
  p.max_damping_n_s_per_mm = it->max_damping_n_s_per_mm;
  p.gives_force = true;
  return p;
}

}  // namespace fettle::haptic
