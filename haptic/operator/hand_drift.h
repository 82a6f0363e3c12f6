#pragma once

#include <cstdint>

#include <glm/vec2.hpp>

#include "haptic/operator/hand_motion.h"

namespace fettle::haptic {

/// How a hand leaves the line that it follows, during one stroke [mm]: tremor, and the slow drift that visual
/// feedback corrects, along each axis. A function of the time since the stroke began.
class HandDrift {
 public:
  HandDrift(double wander_mm, double tremor_mm, std::uint64_t seed, std::uint64_t stroke) noexcept
      : tremor_x_(tremor_mm, kTremorLow, kTremorHigh, seed, kAxes * stroke),
        tremor_y_(tremor_mm, kTremorLow, kTremorHigh, seed, kAxes * stroke + 1),
        tremor_z_(0.5 * tremor_mm, kTremorLow, kTremorHigh, seed, kAxes * stroke + 2),
        wander_x_(wander_mm, kWanderLow, kWanderHigh, seed, kAxes * stroke + 3),
        wander_y_(wander_mm, kWanderLow, kWanderHigh, seed, kAxes * stroke + 4) {}

  [[nodiscard]] glm::dvec2 at(double seconds) const noexcept {
    return {tremor_x_.at(seconds) + wander_x_.at(seconds), tremor_y_.at(seconds) + wander_y_.at(seconds)};
  }
  /// Of the height: half the tremor.
  [[nodiscard]] double heightAt(double seconds) const noexcept { return tremor_z_.at(seconds); }

 private:
  static constexpr std::uint64_t kAxes = 8;  // streams of random numbers for each stroke
  static constexpr double kTremorLow = 8.0;  // [Hz]
  static constexpr double kTremorHigh = 12.0;
  static constexpr double kWanderLow = 0.1;
  static constexpr double kWanderHigh = 1.5;

  HandMotion tremor_x_, tremor_y_, tremor_z_, wander_x_, wander_y_;
};

}  // namespace fettle::haptic
