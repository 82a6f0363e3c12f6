// The closest points of a bilinear patch, all of them.
//
// With everything relative to the endpoint e, S(u, v) - e = (sx u - ex, sy v - ey, z), z = w + p u, where
//   p(v) = b + d v,   q(u) = c + d u,   w(v) = a - ez + c v.
// For a fixed v the distance is quadratic in u, with its one minimum at
//   U(v) = N / Q,   Q = sx^2 + p^2,   N = sx ex - w p.
// Put into the other derivative, sy (sy v - ey) + z q = 0, with z = sx M / Q, M = sx w + ex p, that is
//   h(v) = sy (sy v - ey) Q^2 + sx M (c Q + d N) = 0,
// a quintic. Its roots in [0, 1] are isolated in Bernstein form: the number of sign changes of the
// coefficients bounds the number of roots and is exact when 0 or 1 (Descartes' rule; Lane and Riesenfeld
// 1981, "Bounds on a polynomial"), and halving the interval ends the count. A coefficient below its rounding
// error counts with the sign that makes more changes, so rounding may add a candidate but never lose one that
// matters.

#include "haptic/contact/certified.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "haptic/contact/descent.h"
#include "haptic/contact/hull_distance.h"

namespace fettle::haptic {

namespace {

// Bernstein coefficients of a polynomial of degree N on [0, 1].
template <int N>
using Bernstein = std::array<double, N + 1>;

constexpr double binomial(int n, int k) noexcept {
  double c = 1.0;
  for (int i = 1; i <= k; ++i) c = c * (n - k + i) / i;
  return c;
}

template <int N, int M>
Bernstein<N + M> product(const Bernstein<N>& a, const Bernstein<M>& b) noexcept {
  Bernstein<N + M> out{};
  for (int i = 0; i <= N; ++i)
    for (int j = 0; j <= M; ++j) out[i + j] += binomial(N, i) * binomial(M, j) * a[i] * b[j];
  for (int k = 0; k <= N + M; ++k) out[k] /= binomial(N + M, k);
  return out;
}

using Quintic = Bernstein<5>;

// The parts of h, for evaluating it where rounding is smallest.
struct Reduced {
  double sx, sy, ex, ey;
  double b, c, d, w0;  // w(v) = w0 + c v

  [[nodiscard]] double h(double v) const noexcept {
    const double p = b + d * v;
    const double w = w0 + c * v;
    const double big_q = sx * sx + p * p;
    const double n = sx * ex - w * p;
    return sy * (sy * v - ey) * big_q * big_q + sx * (sx * w + ex * p) * (c * big_q + d * n);
  }
  [[nodiscard]] double u(double v) const noexcept {
    const double p = b + d * v;
    return (sx * ex - (w0 + c * v) * p) / (sx * sx + p * p);
  }
};

double largest(const double* a, int n) noexcept {
  double m = 0.0;
  for (int i = 0; i < n; ++i) m = std::max(m, std::abs(a[i]));
  return m;
}

// h on [low, low + size] in Bernstein form, and how large rounding may have made the error of a coefficient.
// Computed from the linear parts for each interval rather than halved by de Casteljau: next to a spike Q
// spans 24 decades, and its small values would be lost in the rounding of its large ones.
Quintic quintic(const Reduced& r, double low, double size, double& noise) noexcept {
  // One rounding, doubled for the sums of a few.
  constexpr double kEps = 4.5e-16;
  const double v[2] = {low, low + size};
  Bernstein<1> p;
  Bernstein<1> w;
  Bernstein<1> l;
  Bernstein<1> m;
  for (int i = 0; i < 2; ++i) {
    p[i] = r.b + r.d * v[i];
    w[i] = r.w0 + r.c * v[i];
    l[i] = r.sy * (r.sy * v[i] - r.ey);
    m[i] = r.sx * (r.sx * w[i] + r.ex * p[i]);
  }
  Bernstein<2> big_q = product<1, 1>(p, p);
  Bernstein<2> n = product<1, 1>(w, p);
  Bernstein<2> k{};
  for (int i = 0; i < 3; ++i) {
    big_q[i] += r.sx * r.sx;
    n[i] = r.sx * r.ex - n[i];
    k[i] = r.c * big_q[i] + r.d * n[i];
  }
  const Quintic first = product<1, 4>(l, product<2, 2>(big_q, big_q));
  const Quintic second = product<3, 2>(product<1, 2>(m, k), {1.0, 1.0, 1.0});
  Quintic h{};
  for (int i = 0; i <= 5; ++i) h[i] = first[i] + second[i];

  // Sizes on the interval, then errors: of the linear parts relative to what was summed, which may cancel, of
  // the rest by the product rule.
  const double p_size = largest(p.data(), 2);
  const double w_size = largest(w.data(), 2);
  const double l_size = largest(l.data(), 2);
  const double m_size = largest(m.data(), 2);
  const double q_size = r.sx * r.sx + p_size * p_size;
  const double n_size = std::abs(r.sx * r.ex) + w_size * p_size;
  const double dp = kEps * (std::abs(r.b) + std::abs(r.d) * v[1]);
  const double dw = kEps * (std::abs(r.w0) + std::abs(r.c) * v[1]);
  const double dl = kEps * r.sy * (r.sy * v[1] + std::abs(r.ey));
  const double dm =
      r.sx * (r.sx * dw + std::abs(r.ex) * dp) + kEps * r.sx * (r.sx * w_size + std::abs(r.ex) * p_size);
  const double dq = 2.0 * p_size * dp + 2.0 * kEps * q_size;
  const double dn = p_size * dw + w_size * dp + 2.0 * kEps * n_size;
  const double k_size = largest(k.data(), 3);
  const double dk =
      std::abs(r.c) * dq + std::abs(r.d) * dn + kEps * (std::abs(r.c) * q_size + std::abs(r.d) * n_size);
  noise = q_size * q_size * dl + 2.0 * l_size * q_size * dq + m_size * dk + k_size * dm +
          8.0 * kEps * (l_size * q_size * q_size + m_size * k_size);
  return h;
}

enum class Changes { kNone, kOneUp, kOneDown, kPerhaps };

// What the signs of the coefficients say about roots inside the interval.
Changes signChanges(const Quintic& h, double noise) noexcept {
  int changes = 0;
  int first = 0;
  int last = 0;
  for (const double c : h) {
    const int sign = c > noise ? 1 : (c < -noise ? -1 : 0);
    if (sign == 0) return Changes::kPerhaps;
    if (first == 0) first = sign;
    if (last != 0 && sign != last) ++changes;
    last = sign;
  }
  if (changes == 0) return Changes::kNone;
  if (changes > 1) return Changes::kPerhaps;
  return first < 0 ? Changes::kOneUp : Changes::kOneDown;
}

// The root of h between two places, with h below zero at the first and above zero at the second. To full
// precision: next to a spike a patch is a valley along which no other method converges. Secants that do not
// keep one end fixed (Dowell and Jarratt 1971, "A modified regula falsi method"), and the middle wherever
// such a step has not halved what is left, so that 54 halvings are enough for any h.
double rootBetween(const Reduced& r, double low, double high, double h_low, double h_high) noexcept {
  int kept = 0;  // the end that the last step did not move: -1 low, 1 high
  for (int i = 0; i < 54; ++i) {
    const double half = 0.5 * (high - low);
    const double middle = low + half;
    if (!(low < middle && middle < high)) break;
    double x = low - h_low * (high - low) / (h_high - h_low);
    for (int step = 0; step < 2; ++step, x = low + 0.5 * (high - low)) {
      if (!(low < x && x < high)) x = middle;
      const double h = r.h(x);
      if (h < 0.0) {
        low = x;
        h_low = h;
        if (kept == 1) h_high *= 0.5;
        kept = 1;
      } else {
        high = x;
        h_high = h;
        if (kept == -1) h_low *= 0.5;
        kept = -1;
      }
      if (high - low <= half) break;
    }
  }
  return 0.5 * (low + high);
}

// Calls f(v) near every root in [0, 1] at which h goes from below to above zero: the minima along v. May call
// it elsewhere too. kNodes bounds the halvings: five roots need far fewer unless they coincide within
// rounding, and then every point near them is equally good.
void forEachMinimum(const Reduced& r, auto&& f) noexcept {
  struct Interval {
    double low, size;
    int depth;
  };
  constexpr int kDepth = 48;
  constexpr int kNodes = 256;
  std::array<Interval, kDepth + 2> stack;
  stack[0] = {0.0, 1.0, 0};
  int top = 1;
  for (int node = 0; top > 0; ++node) {
    const Interval at = stack[--top];
    double noise = 0.0;
    const Quintic h = quintic(r, at.low, at.size, noise);
    const Changes changes = signChanges(h, noise);
    if (changes == Changes::kNone || changes == Changes::kOneDown) continue;
    if (changes == Changes::kOneUp) {
      f(rootBetween(r, at.low, at.low + at.size, h[0], h[5]));
      continue;
    }
    const bool lost = at.depth >= 20 && largest(h.data(), 6) <= noise;
    if (at.depth == kDepth || node >= kNodes || lost) {
      f(at.low + 0.5 * at.size);
      continue;
    }
    stack[top++] = {at.low + 0.5 * at.size, 0.5 * at.size, at.depth + 1};
    stack[top++] = {at.low, 0.5 * at.size, at.depth + 1};
  }
}

// The smallest magnitude between two numbers.
double least(double a, double b) noexcept {
  return (a > 0.0) == (b > 0.0) ? std::min(std::abs(a), std::abs(b)) : 0.0;
}

double unit(double x) noexcept {
  return std::clamp(x, 0.0, 1.0);
}

void keepNearer(PatchPoint& best, const PatchPoint& point) noexcept {
  if (point.distance2_mm2 < best.distance2_mm2) best = point;
}

// The closest point of the straight line at one v (or u), exact; at 0 and 1 that is an edge.
PatchPoint closestOnEdgeV(const Patch& s, const glm::dvec3& e, double v) noexcept {
  const double p = s.b + s.d * v;
  const double w = s.a - e.z + s.c * v;
  const double ex = e.x - s.x0;
  const double u = unit((s.sx * ex - w * p) / (s.sx * s.sx + p * p));
  const double px = s.sx * u - ex;
  const double py = s.sy * v - (e.y - s.y0);
  const double z = w + p * u;
  return {u, v, px * px + py * py + z * z};
}

PatchPoint closestOnEdgeU(const Patch& s, const glm::dvec3& e, double u) noexcept {
  const Patch turned{s.y0, s.x0, s.sy, s.sx, s.a, s.c, s.b, s.d};
  const PatchPoint point = closestOnEdgeV(turned, {e.y, e.x, e.z}, u);
  return {point.v, point.u, point.distance2_mm2};
}

// Descent from the point below or above the endpoint.
PatchPoint descend(const Patch& s, const glm::dvec3& endpoint) noexcept {
  return closestOnPatch(s, endpoint, unit((endpoint.x - s.x0) / s.sx), unit((endpoint.y - s.y0) / s.sy));
}

}  // namespace

PatchPoint nearestInside(const Patch& s, const glm::dvec3& endpoint, PatchPoint best) noexcept {
  const Reduced r{s.sx, s.sy, endpoint.x - s.x0, endpoint.y - s.y0, s.b, s.c, s.d, s.a - endpoint.z};
  forEachMinimum(r, [&](double v) {
    keepNearer(best, closestOnEdgeV(s, endpoint, unit(v)));  // exact along u at any v
    keepNearer(best, closestOnPatch(s, endpoint, unit(r.u(v)), unit(v)));
  });
  return best;
}

namespace {

// For the case that the descent ended in another minimum: all edges and all stationary points.
PatchPoint bestOfAll(const Patch& s, const glm::dvec3& endpoint, PatchPoint best) noexcept {
  for (const double side : {0.0, 1.0}) {
    keepNearer(best, closestOnEdgeV(s, endpoint, side));
    keepNearer(best, closestOnEdgeU(s, endpoint, side));
  }
  return nearestInside(s, endpoint, best);
}

}  // namespace

// Whether no point of the patch is nearer than `rest`, where the descent ended, apart from rounding. With D =
// (du, dv) the way from there to another point S, and a = e - S(rest),
//   |S - e|^2 = |a|^2 - 2 (a.Su du + a.Sv dv) + (sx^2 + P^2) du^2 + (sy^2 + Q^2) dv^2 + 2 (P Q - k) du dv,
//   P = p + d dv / 2,  Q = q + d du / 2,  k = az d,  p and q the slopes at rest.
// At rest the second term is not above zero for any way that stays in the patch, and the rest is not below
// zero where its determinant sx^2 sy^2 + sx^2 Q^2 + sy^2 P^2 + 2 k P Q - k^2 is not.
bool nothingNearer(const Patch& s, const glm::dvec3& e, const PatchPoint& rest) noexcept {
  const double p = s.b + s.d * rest.v;
  const double q = s.c + s.d * rest.u;
  const glm::dvec3 a = e - s.at(rest.u, rest.v);
  const double along_u = a.x * s.sx + a.z * p;
  const double along_v = a.y * s.sy + a.z * q;
  const double gain = std::max(-along_u * rest.u, along_u * (1.0 - rest.u)) +
                      std::max(-along_v * rest.v, along_v * (1.0 - rest.v));
  if (!(gain <= 1e-13 * rest.distance2_mm2)) return false;
  const double p0 = p - 0.5 * s.d * rest.v;
  const double p1 = p + 0.5 * s.d * (1.0 - rest.v);
  const double q0 = q - 0.5 * s.d * rest.u;
  const double q1 = q + 0.5 * s.d * (1.0 - rest.u);
  const double k = a.z * s.d;
  const double p_low = least(p0, p1);
  const double q_low = least(q0, q1);
  const double product = std::min({k * p0 * q0, k * p0 * q1, k * p1 * q0, k * p1 * q1});
  const double sum = s.sx * s.sx * (s.sy * s.sy + q_low * q_low) + s.sy * s.sy * p_low * p_low;
  return sum + 2.0 * product - k * k > 1e-12 * (sum + 2.0 * std::abs(product) + k * k);
}

PatchPoint closestOnWholePatch(const Patch& s, const glm::dvec3& endpoint) noexcept {
  const PatchPoint rest = descend(s, endpoint);
  return nothingNearer(s, endpoint, rest) ? rest : bestOfAll(s, endpoint, rest);
}

namespace {

double beyond(double x, double low, double high) noexcept {
  return std::max({low - x, x - high, 0.0});
}

// The search over cells; lives on the stack of one call.
class CellSearch {
 public:
  CellSearch(Surface& surface, const glm::dvec3& endpoint, double radius_mm) noexcept
      : surface_(surface), e_(endpoint), radius_mm_(radius_mm), radius2_(radius_mm * radius_mm) {}

  void seed() noexcept {
    CellIndex own;
    if (!surface_.cellUnder(e_, own)) return;
    const SearchResult local = searchDownhill(surface_, e_, own, 0.5, 0.5);
    if (local.end == SearchEnd::kHole || horizontal2(local.point.cell, 1) > radius2_) return;
    best_ = local.point;
  }

  void run() noexcept {
    const double reach_mm = std::min(radius_mm_, std::sqrt(best_.distance2_mm2));
    // A margin on each side: which cells belong is decided by their distance, not by this rounding.
    constexpr double kCellTolerance = 1e-6;
    const auto index = [](double x, std::int32_t cells) {
      return static_cast<std::int32_t>(std::clamp(std::floor(x), -1.0, static_cast<double>(cells)));
    };
    const auto first = [&](double x, double spacing, std::int32_t cells) {
      return std::max(index((x - reach_mm) / spacing - kCellTolerance, cells), 0);
    };
    const auto last = [&](double x, double spacing, std::int32_t cells) {
      return std::min(index((x + reach_mm) / spacing + kCellTolerance, cells), cells - 1);
    };
    const std::int32_t c0 = first(e_.x, surface_.spacingX(), surface_.cellColumns());
    const std::int32_t c1 = last(e_.x, surface_.spacingX(), surface_.cellColumns());
    const std::int32_t r0 = first(e_.y, surface_.spacingY(), surface_.cellRows());
    const std::int32_t r1 = last(e_.y, surface_.spacingY(), surface_.cellRows());
    if (c0 > c1 || r0 > r1) return;
    if (c1 - c0 < kWindowWithoutPyramid && r1 - r0 < kWindowWithoutPyramid)
      cells(c0, r0, c1, r1);
    else
      squares(1, c0, r0, c1, r1);
  }

  [[nodiscard]] const SurfacePoint& best() const noexcept { return best_; }

 private:
  // A window narrower than this (a block of 8 is) is searched cell by cell.
  static constexpr int kWindowWithoutPyramid = 12;

  // Squared horizontal distance to the square of `side` cells from `cell` up.
  [[nodiscard]] double horizontal2(CellIndex cell, int side) const noexcept {
    const double dx =
        beyond(e_.x, cell.column * surface_.spacingX(), (cell.column + side) * surface_.spacingX());
    const double dy = beyond(e_.y, cell.row * surface_.spacingY(), (cell.row + side) * surface_.spacingY());
    return dx * dx + dy * dy;
  }

  // All squares of a pyramid level that the cells [c0, c1] x [r0, r1] touch.
  void squares(int level, std::int32_t c0, std::int32_t r0, std::int32_t c1, std::int32_t r1) noexcept {
    const int shift = 3 * (level + 1);
    for (std::int32_t y = r0 >> shift; y <= r1 >> shift; ++y)
      for (std::int32_t x = c0 >> shift; x <= c1 >> shift; ++x) {
        const CellIndex corner{x << shift, y << shift};
        double low = std::numeric_limits<double>::infinity();
        double high = -low;
        // Cells at the square's upper edges use samples of the next squares.
        for (int k = 0; k < 4; ++k) {
          const engine::HeightBounds b = surface_.reader().bounds(level, x + (k & 1), y + (k >> 1));
          if (b.empty()) continue;
          low = std::min(low, static_cast<double>(b.min) * surface_.heightUnit());
          high = std::max(high, static_cast<double>(b.max) * surface_.heightUnit());
        }
        if (!(low <= high)) continue;
        const double flat2 = horizontal2(corner, 1 << shift);
        const double dz = beyond(e_.z, low, high);
        if (flat2 > radius2_ || flat2 + dz * dz >= best_.distance2_mm2) continue;
        const std::int32_t from_c = std::max(c0, corner.column);
        const std::int32_t from_r = std::max(r0, corner.row);
        const std::int32_t to_c = std::min(c1, corner.column + (1 << shift) - 1);
        const std::int32_t to_r = std::min(r1, corner.row + (1 << shift) - 1);
        if (level == 0)
          cells(from_c, from_r, to_c, to_r);
        else
          squares(level - 1, from_c, from_r, to_c, to_r);
      }
  }

  // Whether the patch, which differs from its middle plane by at most a quarter of its twist, is farther away
  // than the best point, with a margin for rounding.
  [[nodiscard]] bool planeIsBeyond(const Patch& s) const noexcept {
    const double p = (s.b + 0.5 * s.d) / s.sx;
    const double q = (s.c + 0.5 * s.d) / s.sy;
    const double middle = s.a + 0.5 * (s.b + s.c) + 0.25 * s.d;
    const double apart =
        std::abs(e_.z - middle - p * (e_.x - s.x0 - 0.5 * s.sx) - q * (e_.y - s.y0 - 0.5 * s.sy)) -
        0.25 * std::abs(s.d);
    return apart > 0.0 && apart * apart > best_.distance2_mm2 * (1.0 + p * p + q * q) * (1.0 + 1e-9);
  }

  // Approximately the closest point of the patch's middle plane, clamped to the cell.
  [[nodiscard]] glm::dvec3 nearMiddle(const Patch& s) const noexcept {
    const double b = s.b + 0.5 * s.d;
    const double c = s.c + 0.5 * s.d;
    const double x = e_.x - s.x0;
    const double y = e_.y - s.y0;
    const double z = e_.z - s.a + 0.25 * s.d;
    const double uu = s.sx * s.sx + b * b;
    const double vv = s.sy * s.sy + c * c;
    const double uv = b * c;
    const double gu = s.sx * x + b * z;
    const double gv = s.sy * y + c * z;
    const double u = unit((vv * gu - uv * gv) / (uu * vv - uv * uv));
    const double v = unit((gv - uv * u) / vv);
    return s.at(unit((gu - uv * v) / uu), v);
  }

  // At most kWindowWithoutPyramid columns.
  void cells(std::int32_t c0, std::int32_t r0, std::int32_t c1, std::int32_t r1) noexcept {
    // The horizontal distance of a cell is a part along x and a part along y: one of each per column and row
    // of the window, instead of both per cell.
    std::array<double, kWindowWithoutPyramid> dx2;
    for (std::int32_t column = c0; column <= c1; ++column) {
      const double dx = beyond(e_.x, column * surface_.spacingX(), (column + 1) * surface_.spacingX());
      dx2[static_cast<std::size_t>(column - c0)] = dx * dx;
    }
    Patch patch;
    for (std::int32_t row = r0; row <= r1; ++row) {
      const double dy = beyond(e_.y, row * surface_.spacingY(), (row + 1) * surface_.spacingY());
      const double dy2 = dy * dy;
      if (dy2 > radius2_ || dy2 >= best_.distance2_mm2) continue;
      for (std::int32_t column = c0; column <= c1; ++column) {
        const double flat2 = dx2[static_cast<std::size_t>(column - c0)] + dy2;
        if (flat2 > radius2_ || flat2 >= best_.distance2_mm2) continue;
        if (!surface_.patch({column, row}, patch)) continue;
        const double dz = beyond(e_.z, patch.lowest(), patch.highest());
        if (flat2 + dz * dz >= best_.distance2_mm2 || planeIsBeyond(patch)) continue;
        if (hullIsBeyond(patch, best_.position_mm) || hullIsBeyond(patch, nearMiddle(patch))) continue;
        solve({column, row}, patch);
      }
    }
  }

  // From a vertex or an edge where the best point rests, the cells around it are as near as it is, and not
  // nearer: shown by their extent along the line from it to the endpoint, with a margin for rounding.
  [[nodiscard]] bool hullIsBeyond(const Patch& s, const glm::dvec3& from) const noexcept {
    constexpr double kRounding = 1.0 + 4e-15;
    const glm::dvec3 away = e_ - from;
    return hullDistance2(s, e_, away) * kRounding >= best_.distance2_mm2;
  }

  void solve(CellIndex cell, const Patch& patch) noexcept {
    const auto keep = [&](const PatchPoint& point) {
      if (point.distance2_mm2 < best_.distance2_mm2)
        best_ = {cell, point.u, point.v, patch.at(point.u, point.v), point.distance2_mm2};
    };
    const PatchPoint rest = descend(patch, e_);
    keep(rest);
    if (nothingNearer(patch, e_, rest) || hullIsBeyond(patch, patch.at(rest.u, rest.v))) return;
    keep(bestOfAll(patch, e_, rest));
  }

  Surface& surface_;
  glm::dvec3 e_;
  double radius_mm_, radius2_;
  SurfacePoint best_{{}, 0.0, 0.0, {}, std::numeric_limits<double>::infinity()};
};

}  // namespace

bool certifiedClosest(Surface& surface, const glm::dvec3& endpoint, double radius_mm,
                      SurfacePoint& out) noexcept {
  CellSearch search(surface, endpoint, radius_mm);
  search.seed();
  search.run();
  out = search.best();
  return std::isfinite(out.distance2_mm2);
}

}  // namespace fettle::haptic
