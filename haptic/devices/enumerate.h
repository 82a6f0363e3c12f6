#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/error.h"
#include "haptic/devices/device.h"
#include "haptic/devices/virtual/simulated_hand.h"

namespace fettle::haptic {

enum class DeviceKind : std::uint8_t {
  kOther,          ///< a HID device that Fettle has no driver for
  kWoodenHaptics,  ///< over HID
  kWoodenSerial,   ///< a serial board that may be one
  kSpaceMouse,
};

/// "other", "woodenhaptics", "woodenhaptics-serial", "spacemouse".
[[nodiscard]] std::string_view deviceKindName(DeviceKind kind) noexcept;

/// One connected device, as `fettle devices` shows it.
struct DeviceInfo {
  DeviceKind kind = DeviceKind::kOther;
  std::string path;  ///< argument of openDevice(): /dev/hidraw3, /dev/serial/by-id/...
  std::string name;  ///< maker and product, or the id when the device states neither
  std::string serial;
  std::uint16_t vendor = 0;  ///< 0 for serial boards, here and below: not known
  std::uint16_t product = 0;
  std::uint16_t usage_page = 0;
  std::uint16_t usage = 0;
  std::size_t input_bytes = 0;  ///< longest report; 0 = not known
  std::size_t output_bytes = 0;
  bool readable = false;        ///< this user may open it
  int open_error = 0;           ///< errno of the attempt where not; see deviceProblem()
  bool gives_position = false;  ///< 3 axes at least
  bool gives_force = false;
  std::string_view form;  ///< "W8", "P14", "S" where known; else empty
  DeviceProfile profile;  ///< limits that Fettle applies; of kinds other than kOther
};

/// All connected HID devices, and serial boards that may be force devices; those that Fettle can use first. A
/// device is listed even if bus, interface or maker are unknown. Takes some milliseconds.
[[nodiscard]] std::vector<DeviceInfo> listDevices();

/// A device by the word a user gives, not started yet:
///   woodenhaptics[:WHICH]   WHICH = path or serial number; configuration from ~/woodenhaptics.json if it is
///                           there, else woody_v2015
///   serial[:PATH]           WoodenHaptics on a serial board
///   spacemouse[:WHICH]
///   mouse                   MouseStylus
///   hand                    SimulatedHand resting at (0, 0, 0)
///   hand:FILE               SimulatedHand that follows the positions of a strokes file, with its tools
///   replay:FILE             ReplayDevice in real time
///   a path of listDevices() the device there
/// A device that is not plugged in is no error, it may be plugged in later; a path that does not exist is
/// one.
/// Errors (kInput): an unknown word, a bad configuration or strokes file.
/// `loop_rate_hz`: how often the device will be read; the simulated hand's time step follows from it.
[[nodiscard]] engine::Result<std::unique_ptr<Device>> openDevice(const std::string& word,
                                                                 double loop_rate_hz = 1000.0);

/// The positions of a strokes file as a hand's targets: rows that are not finite or whose time does not
/// increase are left out. Empty when no row is left.
[[nodiscard]] std::vector<HandTarget> handPath(std::span<const StrokeSample> strokes);

/// Why a device cannot be opened and what to do, by DeviceInfo::open_error; both empty for 0.
struct DeviceProblem {
  std::string what;    ///< "no permission", "busy", "unplugged" or the system's message
  std::string remedy;  ///< one sentence
};
[[nodiscard]] DeviceProblem deviceProblem(int open_error);

}  // namespace fettle::haptic
