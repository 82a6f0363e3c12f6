#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "engine/base/error.h"
#include "haptic/devices/device.h"
#include "haptic/devices/vendor/force_exchange.h"
#include "haptic/devices/vendor/hdapi.h"
#include "haptic/devices/vendor/wake_up.h"

namespace fettle::haptic {

/// A Touch or Phantom through its maker's library (hdapi.h), whose servo thread calls tick() a thousand times a second. Another thread of
/// ours opens the device, again after it was lost, and closes it: these calls may take seconds.
class OpenHaptics final : public Device {
 public:
  /// `name`: as the maker's setup program calls it; empty: its default device. Asks the device for its limits, where it is there; else it
  /// gets those of an unknown device, also when it comes later. Errors (kFailed): as hdapi().
  [[nodiscard]] static engine::Result<std::unique_ptr<Device>> open(const std::string& name);

  /// What the library answers of a device: its profile, or (kFailed) its error. Opens and closes it.
  [[nodiscard]] static engine::Result<DeviceProfile> probe(const std::string& name);

  OpenHaptics(const Hdapi& hd, std::string name, const DeviceProfile& profile);
  ~OpenHaptics() override;

  [[nodiscard]] const DeviceProfile& profile() const noexcept override { return profile_; }
  [[nodiscard]] DeviceInput read() noexcept override { return exchange_.read(); }
  void write(const glm::dvec3& force_n) noexcept override { exchange_.write(force_n); }
  [[nodiscard]] engine::Status start() override;
  void stop() noexcept override;
  [[nodiscard]] DeviceCounters counters() const noexcept override { return exchange_.counters(); }

 private:
  void supervise() noexcept;
  [[nodiscard]] bool connect() noexcept;
  void disconnect() noexcept;
  [[nodiscard]] bool tick() noexcept;

  const Hdapi& hd_;
  const std::string name_;
  const DeviceProfile profile_;
  ForceExchange exchange_;

  // Set by the supervisor before the servo thread calls tick(), which the library orders.
  unsigned device_ = Hdapi::kInvalidDevice;
  unsigned long scheduled_ = 0;
  glm::dvec3 centre_mm_{0.0};  // of the workspace, in the library's axes

  std::int64_t rests_until_ns_ = 0;  // servo thread's own: motors too warm
  // Relaxed: hints of one thread for another, whose wake-up follows them.
  std::atomic<bool> stopping_{false};
  std::atomic<bool> lost_{false};
  std::atomic<bool> ending_{false};     // only zeros are sent
  std::atomic<bool> zero_sent_{false};  // since then
  WakeUp wake_;                         // of the supervisor
  std::thread supervisor_;
};

}  // namespace fettle::haptic
