// With everything relative to the endpoint, z = w + b u + c v + d u v with w = a - ez, half the gradient of the squared
// distance is
//   (sx (sx u - ex) + z p, sy (sy v - ey) + z q),   p = b + d v,   q = c + d u,
// and half its Hessian
//   (sx^2 + p^2, k; k, sy^2 + q^2),   k = p q + z d = b c - d w + 2 d z.
// Over the cell p, q, z and k, which is linear in z, lie between their values at its corners. So the corners mostly show
// that there is no minimum inside: the gradient vanishes nowhere or the Hessian is indefinite everywhere; or one at most:
// the Hessian is positive definite everywhere.

#include "haptic/contact/closest_on_cell.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "haptic/contact/certified.h"
#include "haptic/contact/pair.h"

namespace fettle::haptic {

namespace {

// Far more than rounding, far less than what would leave many cells undecided.
constexpr double kShapeMargin = 1.0 + 1e-9;

// What the corners of a patch show.
enum class Inside : std::uint8_t {
  kNoMinimum,
  kOneAtMost,  // squared distance is convex
  kUnknown,
};

void keepNearer(PatchPoint& best, const PatchPoint& point) noexcept {
  if (point.distance2_mm2 < best.distance2_mm2) best = point;
}

// Lane by lane 0 where the range between two numbers, whose squares these are, holds 0, else the smaller square.
[[gnu::always_inline]] inline Pair leastSquares(Pair a, Pair b, Pair a2, Pair b2) noexcept {
  return butNot(smaller(a2, b2), atMost(a * b, Pair{0.0, 0.0}));
}

// Everything about u is in the first lane, about v in the second.
[[gnu::always_inline]] inline Inside minimaInside(const Patch& s, const glm::dvec3& e) noexcept {
  const double w = s.a - e.z;
  const Pair spacing{s.sx, s.sy};
  const Pair step2 = spacing * spacing;
  const Pair slope0{s.b, s.c};
  const Pair slope1 = slope0 + Pair{s.d, s.d};
  const Pair square0 = slope0 * slope0;
  const Pair square1 = slope1 * slope1;
  const Pair least = step2 + leastSquares(slope0, slope1, square0, square1);
  const Pair most = step2 + larger(square0, square1);
  const Pair lower{w, w + s.b};
  const Pair upper = lower + Pair{s.c, s.c + s.d};
  const Pair lows = smaller(lower, upper);
  const Pair highs = larger(lower, upper);
  const double z_low = std::min(lows[0], lows[1]);
  const double z_high = std::max(highs[0], highs[1]);

  const double fixed = s.b * s.c - s.d * w;
  const double k0 = fixed + 2.0 * s.d * z_low;
  const double k1 = fixed + 2.0 * s.d * z_high;
  const double k0_2 = k0 * k0;
  const double k1_2 = k1 * k1;
  if (k0 * k1 > 0.0 && std::min(k0_2, k1_2) > most[0] * most[1] * kShapeMargin) return Inside::kNoMinimum;

  const Pair slope_low = smaller(slope0, slope1);
  const Pair slope_high = larger(slope0, slope1);
  const Pair z_low_2{z_low, z_low};
  const Pair z_high_2{z_high, z_high};
  const Pair at_low = spacing * (Pair{s.x0, s.y0} - Pair{e.x, e.y});
  const Pair down = smaller(smaller(z_low_2 * slope_low, z_low_2 * slope_high),
                            smaller(z_high_2 * slope_low, z_high_2 * slope_high));
  const Pair up = larger(larger(z_low_2 * slope_low, z_low_2 * slope_high),
                         larger(z_high_2 * slope_low, z_high_2 * slope_high));
  constexpr double kRounding = 1e-12;
  const Pair rounding =
      Pair{kRounding, kRounding} * (absolute(at_low) + step2 + larger(absolute(down), absolute(up)));
  if (lanes(either(less(rounding, at_low + down), less(at_low + step2 + up, -rounding))) != 0)
    return Inside::kNoMinimum;
  return std::max(k0_2, k1_2) * kShapeMargin < least[0] * least[1] ? Inside::kOneAtMost : Inside::kUnknown;
}

}  // namespace

PatchPoint closestOnEdges(const Patch& s, const glm::dvec3& e) noexcept {
  const double ex = e.x - s.x0;
  const double ey = e.y - s.y0;
  const double w = s.a - e.z;
  // One lane for each of two opposite edges.
  const auto along = [w](double step, double across_step, double along_e, double across_e, double slope,
                         double across_slope, double twist, Pair& to) {
    const Pair p{slope, slope + twist};
    const Pair w_edge{w, w + across_slope};
    to = unit((Pair{step, step} * Pair{along_e, along_e} - w_edge * p) /
              (Pair{step, step} * Pair{step, step} + p * p));
    const Pair near = Pair{step, step} * to - Pair{along_e, along_e};
    const Pair off{-across_e, across_step - across_e};
    const Pair z = w_edge + p * to;
    return near * near + off * off + z * z;
  };
  Pair u, v;
  const Pair f_u = along(s.sx, s.sy, ex, ey, s.b, s.c, s.d, u);
  const Pair f_v = along(s.sy, s.sx, ey, ex, s.c, s.b, s.d, v);
  const PatchPoint along_u = f_u[1] < f_u[0] ? PatchPoint{u[1], 1.0, f_u[1]} : PatchPoint{u[0], 0.0, f_u[0]};
  const PatchPoint along_v = f_v[1] < f_v[0] ? PatchPoint{1.0, v[1], f_v[1]} : PatchPoint{0.0, v[0], f_v[0]};
  return along_v.distance2_mm2 < along_u.distance2_mm2 ? along_v : along_u;
}

PatchPoint closestOnCell(const Patch& s, const glm::dvec3& e, double u0, double v0) noexcept {
  // From inside the patch the point mostly stays inside; from an edge it mostly goes to another.
  const bool from_inside = u0 > 0.0 && u0 < 1.0 && v0 > 0.0 && v0 < 1.0;
  Inside inside = Inside::kUnknown;
  if (from_inside) {
    inside = minimaInside(s, e);
    if (inside == Inside::kOneAtMost) return closestOnPatch(s, e, u0, v0);
  }
  PatchPoint best = closestOnEdges(s, e);
  if (inside == Inside::kNoMinimum) return best;
  if (!from_inside) {
    inside = minimaInside(s, e);
    if (inside == Inside::kNoMinimum) return best;
    u0 = best.u;
    v0 = best.v;
  }
  const PatchPoint rest = closestOnPatch(s, e, u0, v0);
  if (inside == Inside::kOneAtMost) return rest;
  keepNearer(best, rest);
  return nothingNearer(s, e, best) ? best : nearestInside(s, e, best);
}

}  // namespace fettle::haptic
