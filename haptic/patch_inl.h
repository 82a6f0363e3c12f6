#pragma once

#include <algorithm>
#include <cmath>

#include <glm/vec3.hpp>

#include "haptic/pair.h"
#include "haptic/patch.h"

namespace fettle::haptic::detail {

// Newton converges quadratically: a step this small leaves an error of about its square. Smaller steps change
// the distance by less than its last bit, so that comparing distances would stop making sense.
inline constexpr double kLastStep = 1e-7;
// One parameter at a time converges linearly and is exact on an edge: go on to the last bits.
inline constexpr double kLastCoordinateStep = 1e-14;
// Distances this close are the same but for rounding.
inline constexpr double kSame = 1.0 + 1e-15;
// Largest fuv^2 / (fuu fvv) that counts as safely convex.
inline constexpr double kLargestCoupling = 0.998;

/// closestOnPatch, to be inlined where ticks are spent: u and v go through it as one pair, which is what the
/// machine adds, multiplies and compares in one instruction.
[[gnu::always_inline]] inline PatchPoint descendPatch(const Patch& s, const glm::dvec3& endpoint, double u0,
                                                      double v0) noexcept {
  // All relative to the endpoint; f = px^2 + py^2 + z^2, halves of its derivatives throughout.
  const Pair spacing{s.sx, s.sy};
  const Pair spacing2 = spacing * spacing;
  const Pair slope{s.b, s.c};
  const Pair twist{s.d, s.d};
  const Pair zero{0.0, 0.0};
  const Pair one{1.0, 1.0};
  const Pair e = Pair{endpoint.x, endpoint.y} - Pair{s.x0, s.y0};
  const double ez = endpoint.z - s.a;
  Pair at{u0, v0};
  Pair last = at;
  double last_f = HUGE_VAL;
  bool newton_failed = false;
  int shrinks = 0;

  for (int round = 0; round < kNewtonSteps; ++round) {
    const Pair pq = slope + twist * swapped(at);
    const Pair rise = Pair{s.b, pq[1]} * at;
    const double z = rise[0] + rise[1] - ez;
    const Pair away = spacing * at - e;
    const Pair away2 = away * away;
    const double f = away2[0] + away2[1] + z * z;
    if (f > last_f * kSame) [[unlikely]] {
      // Newton overshot: take less of its step, which starts downhill; when even a sliver is no better, the
      // slow way; when that is not either, rounding is all there is.
      if (shrinks < 8) {
        ++shrinks;
        at = last + 0.25 * (at - last);
        continue;
      }
      at = last;
      if (newton_failed) return {at[0], at[1], last_f};
      newton_failed = true;
      last_f = HUGE_VAL;
      continue;
    }
    shrinks = 0;
    last = at;
    last_f = f;

    const Pair g = spacing * away + Pair{z, z} * pq;
    const Pair h = spacing2 + pq * pq;  // fuu, fvv
    const PairMask held =
        either(both(equal(at, zero), atMost(zero, g)), both(equal(at, one), atMost(g, zero)));
    if (const int sides = lanes(held); sides != 0) {
      if (sides == 3) return {at[0], at[1], f};
      // On an edge the distance is quadratic: one exact step, and the next round sees whether it holds. Both
      // lanes are stepped and one is thrown away, because which one is anybody's guess to a branch predictor.
      const Pair step = unit(at - g / h) - at;
      const Pair to = chosen(held, at, unit(at + step));
      const bool rests =
          lanes(either(held, atMost(absolute(step), Pair{kLastCoordinateStep, kLastCoordinateStep}))) == 3;
      if (lanes(equal(at, to)) == 3 && rests) return {to[0], to[1], f};
      at = to;
      if (rests) break;
      newton_failed = false;
      continue;
    }
    double fuv = pq[0] * pq[1] + z * s.d;
    if (fuv * fuv > kLargestCoupling * h[0] * h[1]) [[unlikely]] {
      // Not convex here: with less coupling the step is still downhill, and far better than one parameter at
      // a time, which crawls along valleys.
      fuv = std::copysign(std::sqrt(kLargestCoupling * h[0] * h[1]), fuv);
    }
    if (!newton_failed) [[likely]] {
      const double det = h[0] * h[1] - fuv * fuv;
      const Pair step = (Pair{fuv, fuv} * swapped(g) - swapped(h) * g) / Pair{det, det};
      const Pair to = at + step;
      const int outside = lanes(either(less(to, zero), less(one, to)));
      if (outside == 0) {
        at = to;
        if (std::abs(step[0]) + std::abs(step[1]) <= kLastStep) break;
        continue;
      }
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
        at = Pair{met == 1 ? side[0] : cut_to[0], met == 2 ? side[1] : cut_to[1]};
        if (met == 0 && std::abs(step[0]) + std::abs(step[1]) <= kLastStep) break;
        continue;
      }
    }
    // The exact minimum along u, then along v.
    const double next_u = unit(at - g / h)[0];
    const double q_next = s.c + s.d * next_u;
    const double z_next = s.b * next_u + q_next * at[1] - ez;
    const double next_v =
        std::clamp(at[1] - (s.sy * away[1] + z_next * q_next) / (s.sy * s.sy + q_next * q_next), 0.0, 1.0);
    const double moved = std::abs(next_u - at[0]) + std::abs(next_v - at[1]);
    at = Pair{next_u, next_v};
    if (moved <= kLastCoordinateStep) break;
    newton_failed = false;
  }
  const double q = s.c + s.d * at[0];
  const double z = s.b * at[0] + q * at[1] - ez;
  const Pair away = spacing * at - e;
  const Pair away2 = away * away;
  return {at[0], at[1], away2[0] + away2[1] + z * z};
}

}  // namespace fettle::haptic::detail
