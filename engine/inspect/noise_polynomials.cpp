#include "engine/inspect/noise_polynomials.h"

#include <cmath>

namespace fettle::engine {

namespace {

// Orthonormal polynomials on equally spaced points (Gram 1883), by Gram and Schmidt's steps.
NoisePolynomials makePolynomials() noexcept {
  NoisePolynomials made{};
  for (std::size_t d = 0; d < kNoiseAllDegrees; ++d) {
    std::array<double, kNoiseSide>& p = made[d];
    for (std::size_t i = 0; i < kNoiseSide; ++i)
      p[i] = std::pow((static_cast<double>(i) - 0.5 * (kNoiseSide - 1)) / kNoiseSide, static_cast<double>(d));
    for (std::size_t e = 0; e < d; ++e) {
      double common = 0.0;
      for (std::size_t i = 0; i < kNoiseSide; ++i) common += p[i] * made[e][i];
      for (std::size_t i = 0; i < kNoiseSide; ++i) p[i] -= common * made[e][i];
    }
    double square = 0.0;
    for (const double value : p) square += value * value;
    for (double& value : p) value /= std::sqrt(square);
  }
  return made;
}

}  // namespace

const NoisePolynomials& noisePolynomials() noexcept {
  static const NoisePolynomials made = makePolynomials();
  return made;
}

}  // namespace fettle::engine
