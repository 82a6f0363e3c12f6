#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "haptic/base/latest_slot.h"
#include "haptic/devices/codecs/wooden_codec.h"
#include "haptic/devices/device.h"
#include "haptic/devices/hid/report_link.h"
#include "haptic/devices/wooden/wooden_calibration.h"
#include "haptic/devices/wooden/wooden_config.h"

namespace fettle::haptic {

/// A WoodenHaptics, AluHaptics or Polhem device over any port. The form over HID (W8 or P14) follows from the
/// size of its reports: from the report descriptor, else from the first report. It starts uncalibrated, and
/// again after each re-plug: its encoders lose their zero without power.
class WoodenHaptics final : public Device, private ReportHandler {
 public:
  /// `form`: kS for a serial board; nothing for HID. `serial`: DeviceProfile::serial.
  WoodenHaptics(const WoodenConfig& config, std::unique_ptr<ReportSource> source,
                std::optional<WoodenForm> form = std::nullopt, const OutputTimes& times = {},
                std::string serial = {});
  ~WoodenHaptics() override;

  [[nodiscard]] const DeviceProfile& profile() const noexcept override { return profile_; }
  [[nodiscard]] DeviceInput read() noexcept override;
  void write(const glm::dvec3& force_n) noexcept override;
  [[nodiscard]] engine::Status start() override;
  void stop() noexcept override;
  void calibrate() noexcept override;
  [[nodiscard]] DeviceCounters counters() const noexcept override;

 private:
  Pacing onOpen(std::size_t input_bytes) noexcept override;
  bool onReport(std::span<const std::uint8_t> report, std::int64_t arrival_ns) noexcept override;
  Pacing onCaughtUp(std::uint64_t inputs) noexcept override;
  void onLost() noexcept override;
  std::size_t encode(const glm::dvec3& currents_ma, std::span<std::uint8_t> report) noexcept override;

  // A force is converted into currents at the same pose for which it was computed.
  struct State {
    DeviceInput input;
    glm::dvec3 angles{0.0};
  };

  void setForm(std::optional<WoodenForm> form) noexcept;
  [[nodiscard]] Pacing pacing() const noexcept;

  const WoodenConfig config_;
  const DeviceProfile profile_;
  const std::optional<WoodenForm> fixed_form_;
  const std::array<std::int16_t, 3> home_;

  LatestSlot<State> state_;  // reader thread to loop

  // Reader thread's own.
  std::optional<WoodenForm> form_;
  std::optional<WoodenCalibration> calibration_;
  State newest_;
  std::optional<std::uint16_t> counter_;

  // All relaxed: each is a hint or independent, and seeing it late costs one report.
  std::atomic<int> form_seen_{-1};                  // form_ for the writer thread; -1 = not known
  std::atomic<bool> calibration_requested_{false};  // calibrate() to the reader thread
  std::atomic<bool> preset_requested_{false};       // reader to writer thread
  std::atomic<std::uint32_t> presets_sent_{0};      // writer to reader thread
  std::atomic<bool> may_give_force_{false};         // reader to writer thread: calibrated and connected
  std::atomic<std::uint64_t> scaled_forces_{0};
  std::atomic<std::uint64_t> faults_{0};
  std::atomic<std::uint64_t> lost_inputs_{0};

  ReportLink link_;  // last: its threads use the rest, and end first
};

}  // namespace fettle::haptic
