#pragma once

#include <string>
#include <vector>

#include "app/work/background.h"

namespace fettle::app {

/// A device that can be used in the window, or why not.
struct DeviceChoice {
  std::string words;  ///< of haptic::openDevice
  std::string title;
  std::string problem;  ///< why it cannot be opened; empty: it can
  std::string remedy;
};

/// The mouse, then what is plugged in and Fettle has a driver for. `in_use`: the words of the device that is open: a maker's library that
/// holds a device is not asked for others. Thread: any; a service that does not answer takes half a second.
[[nodiscard]] std::vector<DeviceChoice> listDeviceChoices(const std::string& in_use);

/// The same, listed in the background whenever a list of them is opened. Threading: main.
class DeviceLister {
 public:
  void list(const std::string& in_use);
  /// True when there is another list.
  [[nodiscard]] bool poll();
  [[nodiscard]] bool busy() const noexcept { return listing_.busy(); }
  /// Of the last time; empty before.
  [[nodiscard]] const std::vector<DeviceChoice>& all() const noexcept { return all_; }

 private:
  std::vector<DeviceChoice> all_;
  Background<std::vector<DeviceChoice>> listing_;
};

}  // namespace fettle::app
