#pragma once

#include <cstdint>
#include <memory>
#include <thread>

#include "haptic/devices/device.h"
#include "haptic/devices/vendor/exchange_slots.h"

namespace fettle::haptic {

/// How one kind of device is reached through its maker's library or service.
class Counterpart {
 public:
  virtual ~Counterpart() = default;
  Counterpart& operator=(Counterpart&&) = delete;

  /// Link thread: opens the device, exchanges until it is gone or slots.stopping(), sends a last zero and
  /// closes it. Returns at once when it is not there; is called again until the link stops.
  virtual void serve(ExchangeSlots& slots) noexcept = 0;
};

/// A device that is driven through its maker's library or service, by a link thread that may block: the loop
/// meets it only in ExchangeSlots.
class LinkedDevice final : public Device {
 public:
  /// `hang_ns`: how long stop() waits for a call that does not return; as long as a report to a stalled HID
  /// device takes.
  LinkedDevice(DeviceProfile profile, std::unique_ptr<Counterpart> counterpart,
               std::int64_t hang_ns = 5'000'000'000);
  ~LinkedDevice() override;

  [[nodiscard]] const DeviceProfile& profile() const noexcept override { return profile_; }
  [[nodiscard]] DeviceInput read() noexcept override { return shared_->slots.read(); }
  void write(const glm::dvec3& force_n) noexcept override { shared_->slots.write(force_n); }
  [[nodiscard]] engine::Status start() override;
  /// A call of the library that does not return in time is left behind: its thread sends nothing any more
  /// when it returns, and ends. start() fails until it has.
  void stop() noexcept override;
  void calibrate() noexcept override { shared_->slots.requestCalibration(); }
  [[nodiscard]] DeviceCounters counters() const noexcept override { return shared_->slots.counters(); }

 private:
  // Shared with the thread, which may outlive the device when a call of a library hangs.
  struct Shared {
    ExchangeSlots slots;
    std::unique_ptr<Counterpart> counterpart;
  };
  static void run(Shared& shared) noexcept;

  const DeviceProfile profile_;
  const std::int64_t hang_ns_;
  const std::shared_ptr<Shared> shared_;
  std::thread link_;
};

}  // namespace fettle::haptic
