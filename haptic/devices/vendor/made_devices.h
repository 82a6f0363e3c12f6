#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "haptic/devices/device.h"

namespace fettle::haptic {

/// One device that a maker's library or service reports.
struct MadeDevice {
  std::string argument;  ///< after the driver's word and a colon; may be empty: the first one
  std::string name;
  std::string serial;
  std::string problem;  ///< why it cannot be opened, in the library's words; empty: it can
  std::string remedy;
  DeviceProfile profile;
};

/// What is installed of one maker's software, and what it reports.
struct MadeDevices {
  std::string problem;              ///< why there is none of it; empty: it answers
  std::string remedy;               ///< what to install, and where it was looked for
  std::string source;               ///< the library's file, or the service's address
  std::vector<MadeDevice> devices;  ///< found now
};

// The three kinds. list...() loads the library or asks the service, and takes some milliseconds; open...() likewise,
// for the limits of the device if it is there already. Errors of open...(): kInput, the library is missing or
// incomplete. A device or a service that is not there is no error: it may come later.

/// 3D Systems Touch and Phantom through OpenHaptics. `which`: a device name of the maker's set-up, empty: the
/// default one.
[[nodiscard]] MadeDevices listOpenHaptics();
[[nodiscard]] engine::Result<std::unique_ptr<Device>> openOpenHaptics(const std::string& which);

/// Force Dimension omega, delta, sigma, lambda, and the Novint Falcon through the Force Dimension SDK. `which`:
/// a number from 0; empty: the first.
[[nodiscard]] MadeDevices listForceDimension();
[[nodiscard]] engine::Result<std::unique_ptr<Device>> openForceDimension(const std::string& which);

/// Haply Inverse3 through its service. `which`: a device id; empty: the first.
[[nodiscard]] MadeDevices listInverse3();
[[nodiscard]] engine::Result<std::unique_ptr<Device>> openInverse3(const std::string& which);

}  // namespace fettle::haptic
