#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "haptic/base/sound_tick.h"
#include "haptic/scene/effects.h"
#include "haptic/sound/modal_body.h"

namespace fettle::haptic {

/// The sound of ticks, as samples at 48 kHz:
///
///   rise of the surface -> vertical speed -> without its mean, below 7 kHz -> * force ----+--------------------> + -> limit -> out
///   contact that begins, friction that lets go -> blow of half a millisecond --+          +-> a part of it --+   ^
///   friction that slides -> noise * force * speed ------------------------ (a part) ------------> + -----> body -+
///
/// Loudness of the profile: vertical speed [cells/s] over the speed in plan plus 500 cells/s. A slow hand is as loud as it is fast, a fast
/// one as loud as the surface is steep. Ridges of pitch p passed at speed v are heard at v / p.
///
/// Guarantees. Every sample is within -1 .. 1 and finite, whatever a tick holds (values that are not finite count as 0). At rest, and
/// lifted, the sound fades to exactly 0. Gains change by a time constant of 2 ms, the profile of a tip that is lifted goes on for 2 ms
/// while it fades, blows are smooth and resonators begin at 0: no step is heard that is none of the surface. The same ticks and counts of samples give the same bits on the same libm.
///
/// Sources: van den Doel, Kry, Pai, "FoleyAutomatic" (2001), sections 4 and 5: the profile as a sound that is played at the speed of
/// contact, blows as half cosines, modes excited by both; the low pass: Robert Bristow-Johnson's cookbook of biquads.
///
/// Threading: one thread; noexcept, allocates nothing after construction.
class Synthesiser {
 public:
  static constexpr int kRate_hz = 48000;

  /// `params` in range.
  explicit Synthesiser(const SoundParams& params) noexcept;
  /// From the next sample on.
  void set(const SoundParams& params) noexcept;

  /// The sound of one tick, stretched over `out`, whose length is the tick's time; empty: only what begins in it is taken over.
  void render(const SoundTick& tick, std::span<float> out) noexcept;
  /// What still rings, as if the tip were lifted.
  void fade(std::span<float> out) noexcept { render({}, out); }

 private:
  static constexpr std::size_t kBlowSamples = 24;
  struct Blow {
    double size = 0.0;
    std::size_t at = kBlowSamples;  // ended
  };
  // Two poles and two zeros, transposed.
  struct LowPass {
    double b0 = 0.0, b1 = 0.0, b2 = 0.0, a1 = 0.0, a2 = 0.0, s1 = 0.0, s2 = 0.0;
    LowPass(double cut_hz) noexcept;
    double next(double x) noexcept;
  };
  void strike(double size) noexcept;
  [[nodiscard]] double nextBlow() noexcept;
  [[nodiscard]] double noise() noexcept;
  void settle() noexcept;

  SoundParams params_;
  ModalBody body_;
  LowPass low_pass_;
  double smooth_, mean_pole_, noise_pole_;
  std::array<double, kBlowSamples> blow_shape_{};
  std::array<Blow, 4> blows_{};
  std::array<double, SoundTick::kPieces>
      rise_s_{};             // of the last tick [cells/s]; where it is lifted it is heard on, to and fro
  double closing_ = 0.0;     // by which the level falls per sample, lifted
  double level_ = 0.0;       // of the profile, by force and SoundParams
  double slide_ = 0.0;       // of sliding friction
  double speed_ = 0.0;       // [cells/s]
  double mean_ = 0.0;        // of the profile's sound
  double mean_noise_ = 0.0;  // of the noise
  std::uint32_t random_ = 1;
};

}  // namespace fettle::haptic
