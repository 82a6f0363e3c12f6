#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "engine/scanner/counter_random.h"

namespace fettle::haptic {

/// Band-limited Gaussian motion of a hand along one axis, as a sum of sines with random frequencies in the
/// band and random phases: Rice, Mathematical analysis of random noise (1944), section 1.7. A function of
/// time alone: no state, no start-up, and bounded.
class HandMotion {
 public:
  static constexpr int kSines = 8;
  /// Never farther from zero than this many standard deviations: all sines at their peak, sqrt(2 * kSines).
  static constexpr double kBound = 4.0;

  /// `sigma` in any unit, the band in Hz; `stream` distinguishes axes and strokes.
  HandMotion(double sigma, double low_hz, double high_hz, std::uint64_t seed, std::uint64_t stream) noexcept
      : amplitude_(sigma * std::sqrt(2.0 / kSines)) {
    const engine::CounterRandom random(seed, stream);
    for (int k = 0; k < kSines; ++k) {
      // One sine in each eighth of the band, so that few sines still cover it evenly.
      const double hz = low_hz + (high_hz - low_hz) * (k + random.uniform(k, 0)) / kSines;
      sines_[static_cast<std::size_t>(k)] = {2.0 * std::numbers::pi * hz,
                                             2.0 * std::numbers::pi * random.uniform(k, 1)};
    }
  }

  [[nodiscard]] double at(double seconds) const noexcept {
    double sum = 0.0;
    for (const Sine& s : sines_) sum += std::sin(s.rate * seconds + s.phase);
    return amplitude_ * sum;
  }

 private:
  struct Sine {
    double rate = 0.0;  // [rad/s]
    double phase = 0.0;
  };
  double amplitude_;
  std::array<Sine, kSines> sines_;
};

}  // namespace fettle::haptic
