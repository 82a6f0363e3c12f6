#pragma once

#include <algorithm>
#include <cmath>

#include "haptic/contact/pair.h"
#include "haptic/contact/patch.h"

namespace fettle::haptic::detail {

// Newton converges quadratically: a step this small leaves an error of about its square. Smaller steps change
// the distance by less than its last bit, so that distances could no longer be compared.
inline constexpr double kLastStep = 1e-7;
// One parameter at a time converges linearly and is exact on an edge: continue to full precision.
inline constexpr double kLastCoordinateStep = 1e-14;
// Distances this close are equal apart from rounding.
inline constexpr double kSame = 1.0 + 1e-15;
// Largest fuv^2 / (fuu fvv) that counts as safely convex.
inline constexpr double kLargestCoupling = 0.998;
// Quarterings of a Newton step that was too long, before one coordinate at a time is stepped.
inline constexpr int kMostShrinks = 8;

/// A point of a patch relative to the endpoint: f = away^2 + z^2 and halves of its derivatives. u and v go
/// through all of this as one pair, which the machine adds, multiplies and compares in one instruction.
struct PatchView {
  Pair pq;    ///< slopes along u and v [mm]
  Pair away;  ///< point minus endpoint, x and y [mm]
  double z;   ///< point minus endpoint, height [mm]
  double f;   ///< squared distance [mm^2]

  [[gnu::always_inline]] PatchView(const Patch& s, Pair spacing, Pair e, double ez, Pair at) noexcept
      : pq(Pair{s.b, s.c} + Pair{s.d, s.d} * swapped(at)), away(spacing * at - e) {
    const Pair rise = Pair{s.b, pq[1]} * at;
    z = rise[0] + rise[1] - ez;
    const Pair away2 = away * away;
    f = away2[0] + away2[1] + z * z;
  }
  [[nodiscard, gnu::always_inline]] Pair gradient(Pair spacing) const noexcept {
    return spacing * away + Pair{z, z} * pq;
  }
  /// fuu and fvv.
  [[nodiscard, gnu::always_inline]] Pair curvature(Pair spacing) const noexcept {
    return spacing * spacing + pq * pq;
  }
};

/// The next point of a descent, and whether it is so near that it is the last step.
struct PatchStep {
  Pair to;
  bool last;
};

/// One step down from a point of the patch at which no side stops the descent: Newton's, cut at the first
/// side it meets; or, where that is no descent or after `newton_failed`, the exact minimum along u, then
/// along v.
/// A slow step clears `newton_failed` unless it is the last.
[[nodiscard, gnu::always_inline]] inline PatchStep stepInside(const Patch& s, Pair spacing, double ez,
                                                              Pair at, const PatchView& p, Pair g, Pair h,
                                                              bool& newton_failed) noexcept {
  const Pair zero{0.0, 0.0};
  const Pair one{1.0, 1.0};
  double fuv = p.pq[0] * p.pq[1] + p.z * s.d;
  if (fuv * fuv > kLargestCoupling * h[0] * h[1]) [[unlikely]] {
    // Not convex here: with less coupling the step is still downhill, and far better than one parameter at a
    // time, which is slow along valleys.
    fuv = std::copysign(std::sqrt(kLargestCoupling * h[0] * h[1]), fuv);
  }
  if (!newton_failed) [[likely]] {
    const double det = h[0] * h[1] - fuv * fuv;
    const Pair step = (Pair{fuv, fuv} * swapped(g) - swapped(h) * g) / Pair{det, det};
    const Pair to = at + step;
    const int outside = lanes(either(less(to, zero), less(one, to)));
    if (outside == 0) return {to, std::abs(step[0]) + std::abs(step[1]) <= kLastStep};
    // Cut at the first side it meets: downhill all the way, since the Hessian is positive definite.
    const Pair side{step[0] < 0.0 ? 0.0 : 1.0, step[1] < 0.0 ? 0.0 : 1.0};
    const Pair cuts = (side - at) / step;
    double cut = 1.0;
    int met = 0;
    if ((outside & 1) != 0) {
      cut = cuts[0];
      met = 1;
    }
    if ((outside & 2) != 0 && cuts[1] < cut) {
      cut = cuts[1];
      met = 2;
    }
    if (cut > 0.0) {
      const Pair cut_to = unit(at + Pair{cut, cut} * step);
      return {Pair{met == 1 ? side[0] : cut_to[0], met == 2 ? side[1] : cut_to[1]},
              met == 0 && std::abs(step[0]) + std::abs(step[1]) <= kLastStep};
    }
  }
  const double next_u = unit(at - g / h)[0];
  const double q_next = s.c + s.d * next_u;
  const double z_next = s.b * next_u + q_next * at[1] - ez;
  const double next_v = std::clamp(
      at[1] - (spacing[1] * p.away[1] + z_next * q_next) / (spacing[1] * spacing[1] + q_next * q_next), 0.0,
      1.0);
  const bool last = std::abs(next_u - at[0]) + std::abs(next_v - at[1]) <= kLastCoordinateStep;
  newton_failed = newton_failed && last;
  return {Pair{next_u, next_v}, last};
}

}  // namespace fettle::haptic::detail
