#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "engine/base/error.h"
#include "haptic/devices/device.h"
#include "haptic/devices/vendor/dhd.h"
#include "haptic/devices/vendor/force_exchange.h"

namespace fettle::haptic {

/// An omega, delta, sigma, lambda or Falcon through its maker's library (dhd.h). Its calls block, so that one thread of ours makes them:
/// a force as soon as the loop has written one, then the pose.
class ForceDimension final : public Device {
 public:
  /// `index`: 0, 1, ... as the library numbers what is plugged in; empty: the first. Asks the device for its name, where it is there; else
  /// it gets the limits of an unknown device, also when it comes later. Errors: kInput, no such index; kFailed, as dhd().
  [[nodiscard]] static engine::Result<std::unique_ptr<Device>> open(const std::string& index);

  /// The profiles of what is plugged in, in the library's order; or (kFailed) why none can be. Opens and closes each.
  [[nodiscard]] static engine::Result<std::vector<DeviceProfile>> probe();

  ForceDimension(const Dhd& dhd, char index, const DeviceProfile& profile);
  ~ForceDimension() override;

  [[nodiscard]] const DeviceProfile& profile() const noexcept override { return profile_; }
  [[nodiscard]] DeviceInput read() noexcept override { return exchange_.read(); }
  void write(const glm::dvec3& force_n) noexcept override { exchange_.write(force_n); }
  [[nodiscard]] engine::Status start() override;
  void stop() noexcept override;
  [[nodiscard]] DeviceCounters counters() const noexcept override { return exchange_.counters(); }

 private:
  void run() noexcept;
  void serve(char id) noexcept;
  /// False: the call failed.
  [[nodiscard]] bool readPose(char id) noexcept;

  const Dhd& dhd_;
  const char index_;
  const DeviceProfile profile_;
  ForceExchange exchange_;
  std::atomic<bool> stopping_{false};  // relaxed: looked at again within a second
  WakeUp stopped_;
  std::thread thread_;
};

}  // namespace fettle::haptic
