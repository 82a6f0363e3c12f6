#include "haptic/contact/patch.h"

#include "haptic/contact/patch_inl.h"

namespace fettle::haptic {

using namespace detail;

PatchPoint closestOnPatch(const Patch& s, const glm::dvec3& endpoint, double u0, double v0) noexcept {
  const Pair zero{0.0, 0.0};
  const Pair one{1.0, 1.0};
  const Pair spacing{s.sx, s.sy};
  const Pair e = Pair{endpoint.x, endpoint.y} - Pair{s.x0, s.y0};
  const double ez = endpoint.z - s.a;
  Pair at{u0, v0};
  Pair last = at;
  double last_f = HUGE_VAL;
  bool newton_failed = false;
  int shrinks = 0;

  for (int round = 0; round < kNewtonSteps; ++round) {
    const PatchView p(s, spacing, e, ez, at);
    if (p.f > last_f * kSame) [[unlikely]] {
      // Newton's step was too long: try a part of it, since it starts downhill; when even a small part is no
      // better, one coordinate at a time; when that is no better either, only rounding is left.
      if (shrinks < kMostShrinks) {
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
    last_f = p.f;

    const Pair g = p.gradient(spacing);
    const Pair h = p.curvature(spacing);
    const PairMask held =
        either(both(equal(at, zero), atMost(zero, g)), both(equal(at, one), atMost(g, zero)));
    if (const int sides = lanes(held); sides != 0) {
      if (sides == 3) return {at[0], at[1], p.f};
      // On an edge the distance is quadratic: one exact step, and the next round checks it. Both lanes are
      // stepped and one is discarded, because a branch predictor cannot predict which one.
      const Pair step = unit(at - g / h) - at;
      const Pair to = chosen(held, at, unit(at + step));
      const bool rests =
          lanes(either(held, atMost(absolute(step), Pair{kLastCoordinateStep, kLastCoordinateStep}))) == 3;
      if (lanes(equal(at, to)) == 3 && rests) return {to[0], to[1], p.f};
      at = to;
      if (rests) break;
      newton_failed = false;
      continue;
    }
    const PatchStep step = stepInside(s, spacing, ez, at, p, g, h, newton_failed);
    at = step.to;
    if (step.last) break;
  }
  return {at[0], at[1], PatchView(s, spacing, e, ez, at).f};
}

}  // namespace fettle::haptic
