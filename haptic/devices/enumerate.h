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
  kOpenHaptics,  ///< through its maker's library, here and below
  kForceDimension,
};

/// "other", "woodenhaptics", "woodenhaptics-serial", "spacemouse", "openhaptics",
/// "forcedimension".
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

/// What a maker's library says of its devices.
struct LibraryDevice {
  DeviceKind kind = DeviceKind::kOther;
  std::string words;  ///< argument of openDevice()
  std::string name;
  std::string state;      ///< "ready", "not connected" or "library missing"
  std::string remedy;     ///< empty where it is ready
  DeviceProfile profile;  ///< of one that is ready: limits that Fettle applies
};

/// A row for each device that the libraries of OpenHaptics and Force Dimension open, and for each of both that opens none. Loads these
/// libraries, which a program that uses no such device never does; opening a device may take seconds.
[[nodiscard]] std::vector<LibraryDevice> listLibraryDevices();

/// One device that Fettle can drive: what openDevice(), `fettle devices`, the help of --device and
/// docs/devices.md (a test compares it) know of it.
struct KnownDriver {
  std::string_view word;
  std::string_view argument;  ///< required after word and colon, as "STROKES"; empty: none is
  std::string_view title;
  DeviceKind kind = DeviceKind::kOther;  ///< of what is plugged in; kOther: built in
  bool gives_force = false;              ///< of what is plugged in
  bool needs_window = false;             ///< points at its picture
  /// Not started yet. `argument`: what the user gave after the colon, may be empty:
  /// of hardware a path or serial number, of others a strokes file.
  engine::Result<std::unique_ptr<Device>> (*open)(const std::string& argument, double loop_rate_hz);
  bool simulates_hand = false;  ///< no person holds it, and its time is that of the loop's ticks
};
[[nodiscard]] std::span<const KnownDriver> knownDrivers() noexcept;

/// The driver that a user's words name, with its argument; null for a path of listDevices() and for words that
/// name none.
struct NamedDriver {
  const KnownDriver* driver = nullptr;
  std::string argument;  ///< after the colon; empty where none is given
};
[[nodiscard]] NamedDriver driverNamed(std::string_view words);

/// What a user may say: "woodenhaptics, serial, spacemouse, hand:STROKES, ...".
[[nodiscard]] std::string driverWords();

/// A device by the words a user gives, not started yet: those of driverNamed(), or a path of listDevices().
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
