#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "haptic/devices/hid/report_port.h"

namespace fettle::haptic {

/// A serial board that may be a WoodenHaptics device of form S.
struct SerialBoard {
  std::string path;  ///< e.g. /dev/serial/by-id/usb-Teensyduino_USB_Serial_1234567-if00
  std::string name;  ///< the last part of it
};

/// Boards in /dev/serial/by-id (or another folder) whose name contains "Teensy", sorted by name. Empty when
/// there is no such folder.
[[nodiscard]] std::vector<SerialBoard> serialBoards(const std::string& folder = "/dev/serial/by-id");

/// A terminal line that carries text lines as reports: raw mode, one line with its line end is one report.
/// USB boards ignore the baud rate. A line longer than 255 bytes is split into pieces that no codec accepts.
class SerialSource final : public ReportSource {
 public:
  /// Empty path: the first board of serialBoards().
  explicit SerialSource(std::string path = {}) : path_(std::move(path)) {}
  [[nodiscard]] std::optional<OpenedPorts> open() noexcept override;

 private:
  std::string path_;
};

}  // namespace fettle::haptic
