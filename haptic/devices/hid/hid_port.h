#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "haptic/devices/hid/report_port.h"

namespace fettle::haptic {

/// One HID interface of this machine. Virtual devices have bus 0, interface -1 and no maker; they are listed
/// as well.
struct HidInterface {
  std::string path;  ///< what it is opened by, e.g. /dev/hidraw3
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::uint16_t usage_page = 0;  ///< 0 = not known
  std::uint16_t usage = 0;
  int interface_number = -1;
  std::string manufacturer;  ///< UTF-8, may be empty
  std::string product_name;
  std::string serial;
  std::size_t input_bytes = 0;    ///< longest input report, report id included if it has one; 0 = not known
  std::size_t output_bytes = 0;   ///< longest output report likewise
  bool numbered_reports = false;  ///< reports start with an id byte
};

/// All HID interfaces, in hidapi's order. Takes some milliseconds. Any thread: hidapi keeps its last error in
/// one global text without a lock, so all calls that use it are serialised here.
[[nodiscard]] std::vector<HidInterface> hidInterfaces();

/// Longest input and output report by a HID report descriptor (HID 1.11, section 6.2.2), report id byte
/// included where reports have ids. For malformed descriptors: the sizes found before the fault.
struct ReportSizes {
  std::size_t input_bytes = 0;
  std::size_t output_bytes = 0;
  bool numbered = false;
};
[[nodiscard]] ReportSizes reportSizes(std::span<const std::uint8_t> descriptor) noexcept;

enum class HidKind : std::uint8_t { kNone, kWoodenHaptics, kSpaceMouse };

/// What an interface is. WoodenHaptics: 1234:0006 is a default id that others use as well, so usage page
/// 0xFFAB, usage 0x0200 and 8 or 14 bytes are checked too, each where known. SpaceMouse: 3Dconnexion's ids;
/// of their several interfaces the multi-axis controller (usage page 1, usage 8), where known.
[[nodiscard]] HidKind hidKind(const HidInterface& interface) noexcept;

/// Opens the first connected device of a kind, or the one at `path` or with serial number `path` when that is
/// not empty.
class HidSource final : public ReportSource {
 public:
  explicit HidSource(HidKind kind, std::string path = {}) : kind_(kind), path_(std::move(path)) {}
  [[nodiscard]] std::optional<OpenedPorts> open() noexcept override;

 private:
  HidKind kind_;
  std::string path_;
};

}  // namespace fettle::haptic
