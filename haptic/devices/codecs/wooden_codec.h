#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <glm/vec3.hpp>

namespace fettle::haptic {

/// The wire forms of WoodenHaptics devices; see docs of the makers' firmware
/// (WoodenHaptics/woody-experimental, forsslund/haptikfabrikenapi, forsslund/hfabapi).
enum class WoodenForm : std::uint8_t {
  kW8,   ///< HID, 8 bytes each way, free-running; the firmware's watchdog waits 500 ms
  kP14,  ///< HID, 14 bytes each way, one output for each input; watchdog 500 ms
  kS,    ///< USB serial text lines, one output for each input; watchdog 100 ms
};

/// Longest report of any form, either way, without report id [bytes].
inline constexpr std::size_t kWoodenLongest = 80;

/// Content of one report. Encoders that a form does not carry are 0.
struct WoodenReport {
  std::array<std::int16_t, 6> encoders{};  ///< counts, wrapping at 16 bits
  std::uint16_t counter = 0;               ///< W8: the firmware's report counter; 0 in old firmware
  bool calibration_latched = false;        ///< P14: the button in the home pose's rest was pressed
  bool stylus_button = false;              ///< P14, S: encoded in encoder d, removed from it here
  int fault = 0;                           ///< S: the board's error code; 0 = none

  friend bool operator==(const WoodenReport&, const WoodenReport&) = default;
};

/// Content of one output.
struct WoodenCommand {
  glm::dvec3 ma{0.0};  ///< motor currents a, b, c [mA]; rounded, clamped to +-6000; non-finite = 0
  /// P14: presets encoders a, b, c to these counts instead of setting currents. Other forms ignore it.
  std::optional<std::array<std::int16_t, 3>> preset{};
};

/// The form whose input reports have this many bytes; none for other sizes. HID forms only.
[[nodiscard]] std::optional<WoodenForm> woodenFormOfSize(std::size_t bytes) noexcept;

/// Empty when the bytes are not one whole report of that form: wrong length; for S: not exactly
/// `[n,n,n,n,n,n,n,n]` and an optional line end, or an encoder outside int (encoders wrap to 16 bits).
[[nodiscard]] std::optional<WoodenReport> decodeWooden(WoodenForm form,
                                                       std::span<const std::uint8_t> bytes) noexcept;

/// Writes one output, without report id, and returns its length; `out` holds kWoodenLongest bytes.
[[nodiscard]] std::size_t encodeWooden(WoodenForm form, const WoodenCommand& command,
                                       std::span<std::uint8_t, kWoodenLongest> out) noexcept;

}  // namespace fettle::haptic
