#include "haptic/patch.h"

#include <algorithm>
#include <cmath>

namespace fettle::haptic {

namespace {

// Newton converges quadratically: a step this small leaves an error of about its square. Smaller steps change
// the distance by less than its last bit, so that comparing distances would stop making sense.
constexpr double kLastStep = 1e-7;
// One parameter at a time converges linearly and is exact on an edge: go on to the last bits.
constexpr double kLastCoordinateStep = 1e-14;
// Distances this close are the same but for rounding.
constexpr double kSame = 1.0 + 1e-15;

// Largest fuv^2 / (fuu fvv) that counts as safely convex.
constexpr double kLargestCoupling = 0.998;

double unit(double x) noexcept {
  return std::clamp(x, 0.0, 1.0);
}

}  // namespace

PatchPoint closestOnPatch(const Patch& s, const glm::dvec3& endpoint, double u0, double v0) noexcept {
  // All relative to the endpoint; f = px^2 + py^2 + z^2, halves of its derivatives throughout.
  const double ex = endpoint.x - s.x0;
  const double ey = endpoint.y - s.y0;
  const double ez = endpoint.z - s.a;
  double u = u0;
  double v = v0;
  double last_u = u0;
  double last_v = v0;
  double last_f = HUGE_VAL;
  bool newton_failed = false;
  int shrinks = 0;

  for (int round = 0; round < kNewtonSteps; ++round) {
    const double p = s.b + s.d * v;
    const double q = s.c + s.d * u;
    const double z = s.b * u + q * v - ez;
    const double px = s.sx * u - ex;
    const double py = s.sy * v - ey;
    const double f = px * px + py * py + z * z;
    if (f > last_f * kSame) {
      // Newton overshot: take less of its step, which starts downhill; when even a sliver is no better, the
      // slow way; when that is not either, rounding is all there is.
      if (shrinks < 8) {
        ++shrinks;
        u = last_u + 0.25 * (u - last_u);
        v = last_v + 0.25 * (v - last_v);
        continue;
      }
      u = last_u;
      v = last_v;
      if (newton_failed) return {u, v, last_f};
      newton_failed = true;
      last_f = HUGE_VAL;
      continue;
    }
    shrinks = 0;
    last_u = u;
    last_v = v;
    last_f = f;

    const double gu = s.sx * px + z * p;
    const double gv = s.sy * py + z * q;
    const double fuu = s.sx * s.sx + p * p;
    const double fvv = s.sy * s.sy + q * q;
    const bool u_held = (u == 0.0 && gu >= 0.0) || (u == 1.0 && gu <= 0.0);
    const bool v_held = (v == 0.0 && gv >= 0.0) || (v == 1.0 && gv <= 0.0);
    if (u_held && v_held) return {u, v, f};
    if (u_held || v_held) {
      // On an edge the distance is quadratic: one exact step, and the next round sees whether it holds.
      const double step = u_held ? unit(v - gv / fvv) - v : unit(u - gu / fuu) - u;
      (u_held ? v : u) += step;
      if (v_held) u = unit(u);
      if (u_held) v = unit(v);
      if (std::abs(step) <= kLastCoordinateStep) break;
      newton_failed = false;
      continue;
    }
    double fuv = p * q + z * s.d;
    if (fuv * fuv > kLargestCoupling * fuu * fvv) {
      // Not convex here: with less coupling the step is still downhill, and far better than one parameter at
      // a time, which crawls along valleys.
      fuv = std::copysign(std::sqrt(kLargestCoupling * fuu * fvv), fuv);
    }
    const double det = fuu * fvv - fuv * fuv;
    if (!newton_failed) {
      const double du = (fuv * gv - fvv * gu) / det;
      const double dv = (fuv * gu - fuu * gv) / det;
      // Cut at the first side it meets: downhill all the way, since the Hessian is positive definite.
      double cut = 1.0;
      int side = 0;
      if (u + du < 0.0 || u + du > 1.0) {
        cut = ((du < 0.0 ? 0.0 : 1.0) - u) / du;
        side = 1;
      }
      if (v + dv < 0.0 || v + dv > 1.0) {
        const double cut_v = ((dv < 0.0 ? 0.0 : 1.0) - v) / dv;
        if (cut_v < cut) {
          cut = cut_v;
          side = 2;
        }
      }
      if (cut > 0.0) {
        u = side == 1 ? (du < 0.0 ? 0.0 : 1.0) : unit(u + cut * du);
        v = side == 2 ? (dv < 0.0 ? 0.0 : 1.0) : unit(v + cut * dv);
        if (side == 0 && std::abs(du) + std::abs(dv) <= kLastStep) break;
        continue;
      }
    }
    // The exact minimum along u, then along v.
    const double next_u = unit(u - gu / fuu);
    const double q_next = s.c + s.d * next_u;
    const double z_next = s.b * next_u + q_next * v - ez;
    const double next_v = unit(v - (s.sy * py + z_next * q_next) / (s.sy * s.sy + q_next * q_next));
    const double moved = std::abs(next_u - u) + std::abs(next_v - v);
    u = next_u;
    v = next_v;
    if (moved <= kLastCoordinateStep) break;
    newton_failed = false;
  }
  const double q = s.c + s.d * u;
  const double z = s.b * u + q * v - ez;
  const double px = s.sx * u - ex;
  const double py = s.sy * v - ey;
  return {u, v, px * px + py * py + z * z};
}

}  // namespace fettle::haptic
