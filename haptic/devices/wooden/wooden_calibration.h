#pragma once

#include <array>
#include <cstdint>

#include "haptic/devices/codecs/wooden_codec.h"

namespace fettle::haptic {

/// Follows an encoder whose count wraps at 16 bits. Right as long as it turns less than 32768 counts between
/// two reports (at 1 kHz and 2000 counts per turn: 16,000 turns per second).
class EncoderUnwrap {
 public:
  /// The next count is taken as it is.
  void reset() noexcept { known_ = false; }

  std::int32_t next(std::int16_t raw) noexcept {
    // Differences modulo 2^16, read as signed: the short way round.
    if (known_)
      count_ +=
          static_cast<std::int16_t>(static_cast<std::uint16_t>(raw) - static_cast<std::uint16_t>(last_));
    else
      count_ = raw;
    known_ = true;
    last_ = raw;
    return count_;
  }

 private:
  std::int32_t count_ = 0;
  std::int16_t last_ = 0;
  bool known_ = false;
};

/// The position of the stylus from relative encoders: the user holds it in its home pose, and from then on
/// the counts are absolute. Pure state, no clock, no thread; used by the reader thread only.
class WoodenCalibration {
 public:
  enum class Method : std::uint8_t {
    kHost,    ///< W8, S: the difference to the home pose's counts is kept here
    kDevice,  ///< P14: the device is commanded to preset its encoders; confirmed when they read so
  };

  WoodenCalibration(Method method, const std::array<std::int16_t, 3>& home) noexcept
      : method_(method), home_(home) {}

  /// Takes one report. `requested`: the user asked for a calibration since the last one; the device's own
  /// button (latched) requests it too, once per press. `presets_sent` counts the presets sent so far.
  void onReport(const WoodenReport& report, bool requested, std::uint32_t presets_sent) noexcept {
    const bool pressed = report.calibration_latched && !was_latched_;
    was_latched_ = report.calibration_latched;
    if (requested || pressed) begin(report, presets_sent);
    if (preset_requested_ && presets_sent != presets_before_ && nearHome(report)) {
      preset_requested_ = false;
      calibrated_ = true;
      for (EncoderUnwrap& u : unwrap_) u.reset();
    }
    for (std::size_t i = 0; i < 3; ++i) counts_[i] = unwrap_[i].next(report.encoders[i]) + offset_[i];
  }

  [[nodiscard]] bool calibrated() const noexcept { return calibrated_; }
  /// Whether the device is to be commanded to preset its encoders.
  [[nodiscard]] bool presetRequested() const noexcept { return preset_requested_; }
  /// Encoders a, b, c of the last report, unwrapped; valid once calibrated() is true.
  [[nodiscard]] const std::array<std::int32_t, 3>& counts() const noexcept { return counts_; }

 private:
  // A hand that holds the pose trembles by some counts between the preset and the report that shows it.
  static constexpr int kNear = 200;

  void begin(const WoodenReport& report, std::uint32_t presets_sent) noexcept {
    for (EncoderUnwrap& u : unwrap_) u.reset();
    if (method_ == Method::kHost) {
      for (std::size_t i = 0; i < 3; ++i) offset_[i] = home_[i] - report.encoders[i];
      calibrated_ = true;
      return;
    }
    calibrated_ = false;
    preset_requested_ = true;
    presets_before_ = presets_sent;
  }

  [[nodiscard]] bool nearHome(const WoodenReport& report) const noexcept {
    for (std::size_t i = 0; i < 3; ++i) {
      const int off = report.encoders[i] - home_[i];
      if (off > kNear || off < -kNear) return false;
    }
    return true;
  }

  Method method_;
  std::array<std::int16_t, 3> home_;
  std::array<EncoderUnwrap, 3> unwrap_;
  std::array<std::int32_t, 3> offset_{};
  std::array<std::int32_t, 3> counts_{};
  std::uint32_t presets_before_ = 0;
  bool was_latched_ = false;
  bool preset_requested_ = false;
  bool calibrated_ = false;
};

}  // namespace fettle::haptic
