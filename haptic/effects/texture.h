#pragma once

#include <vector>

#include <glm/vec2.hpp>

#include "haptic/effects/effect.h"

namespace fettle::haptic {

/// A relief h(x, y) that repeats in both directions, as coefficients of a uniform cubic B-spline: h has a
/// continuous second derivative, so force and stiffness have no steps.
///
/// 256 x 256 coefficients, 16 to the wavelength, period 16 wavelengths. Noise: 64 plane waves of fixed
/// pseudo-random direction and phase, each a whole number of times in the period and 12 to 16 times at that,
/// so nothing is shorter than the wavelength or longer than four thirds of it (band-limited noise: Lewis,
/// "Algorithms for solid noise synthesis", 1989). Grating: one sine along x. The same on every machine apart
/// from the last bit of cosines.
class TextureTable {
 public:
  static constexpr int kSide = 256;
  static constexpr int kCyclesMost = 16;  // of a wave in the period
  static constexpr int kCyclesLeast = 12;

  /// Relief and its slopes.
  struct Value {
    double height_mm = 0.0;
    glm::dvec2 slope{0.0};
  };

  explicit TextureTable(const TextureParams& params);

  /// -amplitude <= height <= 0; the grating touches both. Any finite position, over the whole plane.
  [[nodiscard]] Value at(double x_mm, double y_mm) const noexcept;
  [[nodiscard]] std::size_t bytesHeld() const noexcept { return coefficients_.capacity() * sizeof(float); }

 private:
  double per_mm_;  // coefficients per millimetre
  double half_amplitude_mm_;
  std::vector<float> coefficients_;  // row-major, -1 .. 1
};

/// Surface texture: the surface is felt lowered by -h(x, y) along its normal, x and y those of the proxy.
/// With penetration d the tip is d + h deep, and the force is the gradient of K (d + h)^2 / 2:
///   F = K max(d + h, 0) (n - tangential part of grad h)
/// which on a plane is conservative exactly. The relief lies below the field's surface, so that contact
/// begins without a step. On slopes it is stretched by 1 / cos. Changes the press on which friction depends.
///
/// Sources: Minsky, Ouh-young, Steele, Brooks, Behensky, "Feeling and seeing: issues in force display"
/// (1990): lateral forces by the gradient of a relief; Choi and Tan, "Perceived instability of virtual haptic
/// texture" (2004): what texture requires of rate and stiffness.
/// Stability. With largest slope s <= pi A / lambda and curvature c <= 1.02 * 2 pi^2 A / lambda^2
/// (Bernstein's inequality for the band limit; 1.02 is the spline's part), the stiffness that the hand feels
/// in any direction is at most
///   K (1 + s^2) + F_max c,   and   b > T / 2 times that.
/// A sampled relief needs enough samples: crossing it at speed v gives v / lambda cycles per second, which
/// should stay below a tenth of the rate. Cost: 16 coefficients, about 80 multiplications. Memory: 256 KiB,
/// only in a scene that lists it.
AddEffect addTexture;

/// The relief of a scene that lists texture: built once for all effects that use it.
const TextureTable& needRelief(EffectList& list, const Scene& scene);

}  // namespace fettle::haptic
