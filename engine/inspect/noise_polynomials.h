#pragma once

#include <array>
#include <cstddef>

#include "engine/inspect/noise_moments.h"

namespace fettle::engine {

inline constexpr std::size_t kNoiseDegrees = 3;     ///< of the fit to a window: 0, 1, 2
inline constexpr std::size_t kNoiseAllDegrees = 6;  ///< and of what shows that it does not follow the surface

/// [degree][sample of a side]
using NoisePolynomials = std::array<std::array<double, kNoiseSide>, kNoiseAllDegrees>;

/// Orthonormal polynomials on the samples of a window's side (J. Gram 1883). Any thread.
[[nodiscard]] const NoisePolynomials& noisePolynomials() noexcept;

}  // namespace fettle::engine
