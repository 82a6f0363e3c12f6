#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include <glm/vec3.hpp>

#include "haptic/base/latest_slot.h"
#include "haptic/devices/codecs/space_mouse_codec.h"
#include "haptic/devices/device.h"
#include "haptic/devices/hid/report_link.h"

namespace fettle::haptic {

/// How a cap's deflection moves the tip.
struct RateControl {
  double full_speed_mm_s = 100.0;  ///< at full deflection, > 0
  double full_turn_rad_s = 1.0;    ///< turn rate at full deflection, > 0
  double dead_zone = 0.04;         ///< deflection treated as rest, share of full; 0 .. 0.9
  double exponent = 2.0;           ///< of the curve from deflection to speed, 1 .. 4: fine near rest
  double radius_mm = 100.0;        ///< the tip stays in this ball, > 0
  double hold_s = 0.5;             ///< without a report for this long the cap counts as released, > 0
};

/// Speed of one axis, -1 .. 1 of full, for a deflection -350 .. 350: zero in the dead zone, then rising
/// without a step. Odd and monotonic.
[[nodiscard]] double rateOf(std::int16_t deflection, const RateControl& control) noexcept;

/// A 3Dconnexion SpaceMouse: rate control of the tip, no force. read() integrates the deflection over the
/// time since the read() before, so each read is a new input even while the cap rests and the mouse sends
/// nothing. Needs no calibration; after a re-plug the tip is where it was.
class SpaceMouse final : public Device, private ReportHandler {
 public:
  explicit SpaceMouse(std::unique_ptr<ReportSource> source, const RateControl& control = {});
  ~SpaceMouse() override;

  [[nodiscard]] const DeviceProfile& profile() const noexcept override { return profile_; }
  [[nodiscard]] DeviceInput read() noexcept override;
  void write(const glm::dvec3&) noexcept override {}
  [[nodiscard]] engine::Status start() override { return link_.start(); }
  void stop() noexcept override { link_.stop(); }
  [[nodiscard]] DeviceCounters counters() const noexcept override { return link_.counters(); }

  /// Loop thread: turn rates about x (right), y (away), z (up) of the last read() [rad/s], for the view.
  [[nodiscard]] const glm::dvec3& turn() const noexcept { return turn_; }

  /// read() at a time given by the caller [ns]; read() takes the steady clock. For replays and tests.
  [[nodiscard]] DeviceInput readAt(std::int64_t now_ns) noexcept;

 private:
  Pacing onOpen(std::size_t input_bytes) noexcept override;
  bool onReport(std::span<const std::uint8_t> report, std::int64_t arrival_ns) noexcept override;
  Pacing onCaughtUp(std::uint64_t inputs) noexcept override;
  void onLost() noexcept override;

  std::size_t encode(const glm::dvec3&, std::span<std::uint8_t>) noexcept override { return 0; }

  struct Cap {
    SpaceMouseState state;
    std::int64_t arrival_ns = 0;
    LinkState link = LinkState::kDisconnected;
  };

  const RateControl control_;
  const DeviceProfile profile_;
  LatestSlot<Cap> cap_;  // reader thread to loop
  Cap newest_;           // reader thread's own

  // The loop's own.
  DeviceInput input_;
  glm::dvec3 turn_{0.0};
  std::int64_t last_read_ns_ = 0;

  ReportLink link_;
};

}  // namespace fettle::haptic
