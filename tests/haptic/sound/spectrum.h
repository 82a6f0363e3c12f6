#pragma once

#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "haptic/sound/synthesiser.h"

namespace fettle::haptic::tests {

/// Amplitude of a sound at a frequency, over a Hann window: Goertzel's algorithm, as a plain sum.
inline double amplitudeAt(std::span<const float> sound, double hz) {
  double re = 0.0, im = 0.0, weight = 0.0;
  for (std::size_t i = 0; i < sound.size(); ++i) {
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(i);
    const double hann = 0.5 - 0.5 * std::cos(turn / static_cast<double>(sound.size()));
    const double phase = turn * hz / Synthesiser::kRate_hz;
    re += hann * sound[i] * std::cos(phase);
    im -= hann * sound[i] * std::sin(phase);
    weight += hann;
  }
  return 2.0 * std::hypot(re, im) / weight;
}

/// The loudest frequency between two, in steps.
inline double peakHz(std::span<const float> sound, double low_hz, double high_hz, double step_hz) {
  double best = low_hz, most = -1.0;
  for (double hz = low_hz; hz <= high_hz; hz += step_hz)
    if (const double a = amplitudeAt(sound, hz); a > most) {
      most = a;
      best = hz;
    }
  return best;
}

inline double rms(std::span<const float> sound) {
  double sum = 0.0;
  for (const float s : sound) sum += static_cast<double>(s) * static_cast<double>(s);
  return sound.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(sound.size()));
}

/// The largest difference between neighbouring samples.
inline double steepestStep(std::span<const float> sound) {
  double most = 0.0;
  for (std::size_t i = 1; i < sound.size(); ++i)
    most = std::max(most, std::abs(static_cast<double>(sound[i]) - static_cast<double>(sound[i - 1])));
  return most;
}

}  // namespace fettle::haptic::tests
