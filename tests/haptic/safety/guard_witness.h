#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include <glm/geometric.hpp>

#include "haptic/safety/safety.h"

namespace fettle::haptic::tests {

/// Steps a guard and holds every step to the promises of safety.h, whatever the input.
class GuardWitness {
 public:
  explicit GuardWitness(const SafetyLimits& limits) : guard_(limits) {}

  ForceGuard& guard() { return guard_; }
  void arm() {
    armed_since_fault_ = true;
    guard_.arm();
  }

  glm::dvec3 step(const SafetyInput& input) {
    const SafetyState before = guard_.state();
    const glm::dvec3 previous = guard_.force();
    const glm::dvec3 f = guard_.step(input);
    const SafetyLimits& limits = guard_.limits();
    if (!(std::isfinite(f.x) && std::isfinite(f.y) && std::isfinite(f.z))) return broken("not finite", f);
    // Clamping scales a vector: relative error of a few roundings.
    const double size = glm::length(f);
    if (!(size <= limits.peak_force_n * (1.0 + 1e-12))) return broken("above the peak", f);
    const bool good_time = std::isfinite(input.dt_s) && input.dt_s > 0.0 && std::isfinite(input.input_age_s);
    const double dt_s = good_time ? input.dt_s : 0.001;
    const double change = glm::length(f - previous);
    const bool gone = input.link == LinkState::kDisconnected;
    if (gone && size != 0.0) return broken("force without a device", f);
    // 1e-9 N: roundings of vectors of newtons.
    if (!gone && change > 1000.0 * limits.slew_n_per_ms * dt_s + 1e-9) return broken("slew exceeded", f);
    if (!input.output_pending) held_ = previous;
    if (gone) held_ = glm::dvec3(0.0);
    if (input.output_pending && size > glm::length(held_) + 2.0 * limits.slew_n_per_ms + 1e-9)
      return broken("a kick after missed reports", f);
    const SafetyState state = guard_.state();
    const bool may_rise = state == SafetyState::kRamping || state == SafetyState::kActive;
    if (!may_rise && size > glm::length(previous) + 1e-12)
      return broken("rises in " + std::string(name(state)), f);
    if (input.command_n != input.command_n && size > glm::length(previous) + 1e-12)
      return broken("rises on a NaN", f);
    if (before == SafetyState::kFault && state != SafetyState::kFault && !armed_since_fault_)
      return broken("fault not latched", f);
    armed_since_fault_ = false;
    if (good_time && !gone) {
      peak_rate_n_per_s_ = std::max(peak_rate_n_per_s_, change / dt_s);
      peak_rise_n_ = std::max(peak_rise_n_, size - glm::length(previous));
    }
    peak_n_ = std::max(peak_n_, size);
    return f;
  }

  [[nodiscard]] const std::optional<std::string>& problem() const { return problem_; }
  [[nodiscard]] double peakForce() const { return peak_n_; }
  [[nodiscard]] double peakRate() const { return peak_rate_n_per_s_; }
  [[nodiscard]] double peakRise() const { return peak_rise_n_; }
  void forgetPeaks() { peak_n_ = peak_rate_n_per_s_ = peak_rise_n_ = 0.0; }

 private:
  glm::dvec3 broken(const std::string& what, const glm::dvec3& f) {
    if (!problem_)
      problem_ = what + " at step " + std::to_string(guard_.counters().ticks) + ": " + std::to_string(f.x) +
                 " " + std::to_string(f.y) + " " + std::to_string(f.z);
    return f;
  }

  ForceGuard guard_;
  glm::dvec3 held_{0.0};  // what the device has while it waits for a report
  bool armed_since_fault_ = false;
  std::optional<std::string> problem_;
  double peak_n_ = 0.0, peak_rate_n_per_s_ = 0.0, peak_rise_n_ = 0.0;
};

}  // namespace fettle::haptic::tests
