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
  kOpenHaptics,  ///< through what its maker installs, see listMakers(); likewise the two below
  kForceDimension,
  kInverse3,
};

/// "other", "woodenhaptics", "woodenhaptics-serial", "spacemouse", "touch", "forcedimension", "inverse3".
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
  std::string answer;     ///< of listMakers(): why it cannot be opened; empty: it can
  std::string advice;     ///< of listMakers(): what the user has to do; may be empty
};

/// All connected HID devices, and serial boards that may be force devices; those that Fettle can use first. A
/// device is listed even if bus, interface or maker are unknown. Takes some milliseconds.
[[nodiscard]] std::vector<DeviceInfo> listDevices();

/// What one maker's own software reports, which is loaded or asked only here and when such a device is opened.
struct MakerInfo {
  DeviceKind kind = DeviceKind::kOther;
  std::string_view word;   ///< of the driver
  std::string_view title;  ///< of the driver
  std::string problem;  ///< why there are no devices of it, as "libHD.so is not installed"; empty: it answers
  std::string remedy;   ///< what to install, and where it was looked for
  std::string source;   ///< the library's file, or the service's address; may be empty
  /// Devices that it reports. `path` is a word of openDevice() with its argument; `answer` is why one cannot be
  /// opened, in the library's words.
  std::vector<DeviceInfo> devices;
};

/// In the order of knownDrivers(). Takes some milliseconds; a service that does not answer, half a second.
[[nodiscard]] std::vector<MakerInfo> listMakers();

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
/// Those of them that need no argument: "woodenhaptics", "serial", ...
[[nodiscard]] std::vector<std::string> driversAlone();

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
