#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "haptic/base/strokes.h"
#include "haptic/devices/device.h"

namespace fettle::haptic {

enum class ReplayPace : std::uint8_t {
  kRealTime,  ///< the row whose time has come, by the clock: rows may be skipped or repeated
  kEachRead,  ///< one row per read(), whatever the time: every row once, the same on every run
};

/// A recorded strokes file as a device, in field coordinates, with the recorded tool. Ignores force. Before
/// the first row's time the first row is returned, after the end the last one; a row of NaN (a recorded
/// dropout) is returned unchanged. Disconnected when there are no rows. Loop thread only.
class ReplayDevice final : public Device {
 public:
  /// Rows with times that never decrease (a file's `t` column); rows that do are played at the time before.
  explicit ReplayDevice(std::vector<StrokeSample> strokes, ReplayPace pace = ReplayPace::kRealTime);

  [[nodiscard]] const DeviceProfile& profile() const noexcept override { return profile_; }
  [[nodiscard]] DeviceInput read() noexcept override;
  void write(const glm::dvec3&) noexcept override {}
  /// From the first row again.
  [[nodiscard]] engine::Status start() override;
  void stop() noexcept override {}

  /// Every row was read.
  [[nodiscard]] bool finished() const noexcept { return read_rows_ >= strokes_.size(); }

  /// read() at a time given by the caller [ns]; the first one starts the clock. For tests.
  [[nodiscard]] DeviceInput readAt(std::int64_t now_ns) noexcept;

 private:
  std::vector<StrokeSample> strokes_;
  ReplayPace pace_;
  DeviceProfile profile_;
  std::size_t read_rows_ = 0;  // the current row is the one before
  std::int64_t started_ns_ = 0;
  bool started_ = false;
  DeviceInput input_;
};

}  // namespace fettle::haptic
