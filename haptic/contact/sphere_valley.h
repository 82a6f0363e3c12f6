#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <glm/vec3.hpp>

#include "haptic/contact/sphere_window.h"

namespace fettle::haptic {

/// How far x is outside [low, high]; 0 within.
[[nodiscard]] inline double beyondRange(double x, double low, double high) noexcept {
  return std::max({low - x, x - high, 0.0});
}

/// Minima inside the cell. The distance is quadratic in u, so that along v there is a function of v alone,
///   g(v) = min over u of f(u, v),   u(v) = (sx ex - w p) / (sx^2 + p^2),   p = b + d v,   w = a - cz + c v,
/// (halves throughout), whose minima with 0 < u(v) < 1 are those of the patch (the reduction of
/// certified.cpp).
class SphereWindow::Valley {
 public:
  Valley(const SphereWindow& w, const glm::dvec3& centre, std::int32_t i, std::int32_t j,
         const Corners& z) noexcept
      : sx(w.sx_),
        sy(w.sy_),
        b(z.z10 - z.z00),
        c(z.z01 - z.z00),
        d((z.z11 - z.z01) - b),
        ex(centre.x - (w.column_ + i) * sx),
        ey(centre.y - (w.row_ + j) * sy),
        w0(z.z00 - centre.z) {}

  // Slope of g; also stores u, the height and g's second derivative.
  [[nodiscard]] double slopeAt(double v) noexcept {
    const double p = b + d * v;
    const double w = w0 + c * v;
    const double uu = sx * sx + p * p;
    u = (sx * ex - w * p) / uu;
    height = w + p * u;
    const double q = c + d * u;
    const double uv = p * q + height * d;
    bend = sy * sy + q * q - uv * uv / uu;
    return sy * (sy * v - ey) + height * q;
  }

  // The same for a steep cell, where w + p u loses what remains of heights that are larger by ten decades.
  [[nodiscard]] double steepSlopeAt(double v) noexcept {
    const double p = b + d * v;
    const double w = w0 + c * v;
    const double uu = sx * sx + p * p;
    u = (sx * ex - w * p) / uu;
    height = sx * (sx * w + ex * p) / uu;
    const double q = c + d * u;
    const double uv = p * q + height * d;
    bend = sy * sy + q * q - uv * uv / uu;
    return sy * (sy * v - ey) + height * q;
  }

  [[nodiscard]] bool mayHold(int piece, double reach2) const noexcept {
    return mayHold(static_cast<double>(piece) / kTwistPieces, (piece + 1.0) / kTwistPieces, reach2);
  }

  // Whether a piece may hold a minimum nearer than the reach. u (sx^2 + p^2) = sx ex - w p, where p and w are
  // linear along v: from their ends a range of u, from that a range of heights, all wider than any rounding.
  [[nodiscard]] bool mayHold(double v0, double v1, double reach2) const noexcept {
    constexpr double kWider = 1e-9;
    const double p0 = b + d * v0;
    const double p1 = b + d * v1;
    const double h0 = w0 + c * v0;
    const double h1 = w0 + c * v1;
    const auto [least, most] = std::minmax({h0 * p0, h0 * p1, h1 * p0, h1 * p1});
    const auto [flat, steep] = std::minmax({p0 * p0, p1 * p1});
    const double uu_most = sx * sx + steep;
    const double uu_least = sx * sx + (p0 * p1 > 0.0 ? flat : 0.0);
    const double at = sx * ex;
    const double margin = kWider * (uu_most + std::abs(at) + std::max(most, -least));
    const double n_least = at - most - margin;
    const double n_most = at - least + margin;
    if (n_most < 0.0 || n_least > uu_most) return false;
    const double u0 = std::max(n_least / uu_most - kWider, 0.0);
    const double u1 = std::min(n_most / uu_least + kWider, 1.0);
    const auto [lowest, highest] = std::minmax({h0 + p0 * u0, h0 + p0 * u1, h1 + p1 * u0, h1 + p1 * u1});
    const double margin_z = kWider * (std::abs(h0) + std::abs(h1) + std::abs(p0) + std::abs(p1));
    if (lowest > margin_z) return false;
    const double mx = beyondRange(ex, sx * u0, sx * u1);
    const double my = beyondRange(ey, sy * v0, sy * v1);
    const double mz = std::max(-highest - margin_z, 0.0);
    return mx * mx + my * my + mz * mz <= reach2 * (1.0 + 1e-6);
  }

  // How far g is alike around v, next to which pieces must be shorter: u and the height change most where p or w is 0, over
  // some sx / |d| there, and over a part of the way to there elsewhere.
  [[nodiscard]] double scaleAt(double v) const noexcept {
    const double least = 0.5 * std::min(sx, sy) / std::abs(d);
    const double to_p = std::abs(v + b / d);
    const double to_w = c != 0.0 ? std::abs(v + w0 / c) : 1.0;
    return std::max(std::min(to_p, to_w), least);
  }

  // Where a piece of a steep cell ends that begins at v < 1: half of the scale there farther, at most 1 / kTwistPieces and at
  // least some roundings of v, for any twist. Each end waits for the one before, so halves are taken beforehand, exactly, and
  // the bounds of the scale with those of the piece: half the least scale of a steep cell is below 1 / kTwistPieces.
  class Pieces {
   public:
    explicit Pieces(const Valley& g) noexcept
        : least_(std::max(0.25 * std::min(g.sx, g.sy) / std::abs(g.d), 4e-16)),
          p_(0.5 * (g.b / g.d)),
          w_(g.c != 0.0 ? 0.5 * (g.w0 / g.c) : HUGE_VAL) {}
    [[nodiscard]] double end(double v) const noexcept {
      const double half = 0.5 * v;
      const double to = std::min(std::abs(half + p_), std::abs(half + w_));
      return std::min(v + std::max(std::min(to, 1.0 / kTwistPieces), least_), 1.0);
    }

   private:
    double least_, p_, w_;  // halves of the least scale, and of where p or w is 0
  };

  [[nodiscard]] LaneValley lanes() const noexcept { return {b, c, d, ex, ey, w0, sx, sy}; }

  double sx, sy, b, c, d, ex, ey, w0;
  double u = 0.0, height = 0.0, bend = 0.0;
};

}  // namespace fettle::haptic
