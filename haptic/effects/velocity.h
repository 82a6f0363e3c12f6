#pragma once

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "haptic/scene/effects.h"

namespace fettle::haptic {

/// The velocity of the endpoint [mm/s]: differences between ticks through a first-order low pass,
///   v <- v + a ((x - x') / dt - v),   a = dt / (dt + tau).
/// It lags by dt / 2 of the difference and tau of the low pass: 2.5 ms with the default of 2 ms at 1 kHz.
/// Times are the samples' own, so a replay and the live loop compute the same, and a skipped tick counts.
///
/// Restarts, at rest, when the speed of the hand cannot be known: first input, time that does not advance,
/// goes back or is not finite, a gap above 20 ms, a step faster than any hand (VelocityParams::fastest_mm_per_s: a jump).
/// A restart gives zero velocity, so forces that depend on it fade out and never jump.
///
/// Source: the filtered backward difference is the common choice; its part in stability is derived in Colgate
/// and Brown, "Factors affecting the Z-width of a haptic display" (1994), and effects/viscosity.cpp. Threading:
/// one thread; noexcept, allocates nothing.
class VelocityFilter {
 public:
  static constexpr double kLongestGap_s = 0.020;

  /// `tau_s` >= 0; `fastest_mm_s` > 0.
  explicit VelocityFilter(double tau_s, double fastest_mm_s = VelocityParams{}.fastest_mm_per_s) noexcept
      : tau_s_(tau_s), fastest_mm_s_(fastest_mm_s) {}

  /// One input; `at_mm` finite.
  void update(double t_s, const glm::dvec3& at_mm) noexcept {
    const double dt_s = t_s - t_s_;
    const glm::dvec3 step = at_mm - at_mm_;
    t_s_ = t_s;
    at_mm_ = at_mm;
    // Negated, so that NaN restarts; a step too far to be squared has an infinite length.
    const bool continuous =
        known_ && dt_s > 0.0 && dt_s <= kLongestGap_s && glm::length(step) <= fastest_mm_s_ * dt_s;
    known_ = true;
    dt_s_ = continuous ? dt_s : 0.0;
    v_ = continuous ? v_ + (dt_s / (dt_s + tau_s_)) * (step / dt_s - v_) : glm::dvec3(0.0);
  }
  /// The next input is the first.
  void reset() noexcept {
    known_ = false;
    dt_s_ = 0.0;
    v_ = glm::dvec3(0.0);
  }

  [[nodiscard]] const glm::dvec3& mmPerS() const noexcept { return v_; }
  /// Between the last two inputs [s]; 0 when the last one was a start.
  [[nodiscard]] double dt() const noexcept { return dt_s_; }

 private:
  double tau_s_, fastest_mm_s_;
  double t_s_ = 0.0;
  double dt_s_ = 0.0;
  glm::dvec3 at_mm_{0.0};
  glm::dvec3 v_{0.0};
  bool known_ = false;
};

}  // namespace fettle::haptic
