#include "bench/accuracy/literal_search.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "haptic/contact/certified.h"
#include "haptic/contact/collision.h"

namespace fettle::bench {

using haptic::CellIndex;

namespace {

// As level paper has it: a shorter distance is shorter by more than rounding.
double shorter(double distance2, const glm::dvec3& e) {
  return distance2 -
         4e-15 * (distance2 + std::sqrt(distance2) * (std::abs(e.x) + std::abs(e.y) + std::abs(e.z)));
}

// A cell with its endpoint; `turned` exchanges u and v.
struct LiteralCell {
  double sx, sy, ex, ey, ez;
  double a, b, c, d;

  [[nodiscard]] LiteralCell turned() const { return {sy, sx, ey, ex, ez, a, c, b, d}; }
  [[nodiscard]] double distance2(double u, double v) const {
    const double x = u * sx - ex, y = v * sy - ey, z = a + b * u + c * v + d * u * v - ez;
    return x * x + y * y + z * z;
  }
  // Where the distance is least along the line of one v.
  [[nodiscard]] double bestU(double v) const {
    const double p = b + d * v, w = a + c * v - ez;
    return std::clamp((sx * ex - w * p) / (sx * sx + p * p), 0.0, 1.0);
  }
  [[nodiscard]] double along(double v) const { return distance2(bestU(v), v); }
};

struct LiteralBest {
  double u = 0.0, v = 0.0, distance2 = HUGE_VAL;
  void keep(double at_u, double at_v, const LiteralCell& cell) {
    const double d2 = cell.distance2(at_u, at_v);
    if (d2 < distance2) *this = {at_u, at_v, d2};
  }
};

// Newton's method from a place inside; what is nearer on its way is kept.
void polish(const LiteralCell& s, double u, double v, LiteralBest& best) {
  for (int i = 0; i < 8; ++i) {
    const double p = s.b + s.d * v, q = s.c + s.d * u;
    const double z = s.a + s.b * u + s.c * v + s.d * u * v - s.ez;
    const double gu = s.sx * (s.sx * u - s.ex) + z * p, gv = s.sy * (s.sy * v - s.ey) + z * q;
    const double huu = s.sx * s.sx + p * p, hvv = s.sy * s.sy + q * q, huv = p * q + z * s.d;
    const double det = huu * hvv - huv * huv;
    if (!(det > 0.0)) return;
    u = std::clamp(u - (hvv * gu - huv * gv) / det, 0.0, 1.0);
    v = std::clamp(v - (huu * gv - huv * gu) / det, 0.0, 1.0);
    best.keep(u, v, s);
  }
}

// All minima of the distance along v, its minimum along u being known for every v.
void scanAlongV(const LiteralCell& s, LiteralBest& best) {
  constexpr int kPlaces = 64;
  constexpr double kGolden = 0.6180339887498949;
  std::array<double, kPlaces + 1> f;
  for (int i = 0; i <= kPlaces; ++i) {
    const double v = static_cast<double>(i) / kPlaces;
    f[static_cast<std::size_t>(i)] = s.along(v);
    best.keep(s.bestU(v), v, s);
  }
  for (int i = 0; i <= kPlaces; ++i) {
    const auto at = [&](int k) { return k < 0 || k > kPlaces ? HUGE_VAL : f[static_cast<std::size_t>(k)]; };
    if (at(i - 1) < at(i) || at(i + 1) < at(i)) continue;
    double low = std::max(0, i - 1) / static_cast<double>(kPlaces);
    double high = std::min(kPlaces, i + 1) / static_cast<double>(kPlaces);
    for (int k = 0; k < 60; ++k) {
      const double x = high - kGolden * (high - low), y = low + kGolden * (high - low);
      (s.along(x) <= s.along(y) ? high : low) = s.along(x) <= s.along(y) ? y : x;
    }
    const double v = 0.5 * (low + high);
    best.keep(s.bestU(v), v, s);
    polish(s, s.bestU(v), v, best);
  }
}

}  // namespace

LiteralSearch::LiteralSearch(const engine::Version& field)
    : width_(field.grid().width),
      height_(field.grid().height),
      sx_(field.grid().spacingXMm()),
      sy_(field.grid().spacingYMm()) {
  const engine::FieldReader reader = field.reader();
  heights_.reserve(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  for (std::int32_t row = 0; row < height_; ++row)
    for (std::int32_t column = 0; column < width_; ++column)
      heights_.push_back(static_cast<double>(reader.heightAt(column, row)) * field.grid().height_unit.mm);
}

bool LiteralSearch::bounded(CellIndex cell, const glm::dvec3& e, LiteralPoint& out) const {
  if (cell.column < 0 || cell.row < 0 || cell.column >= width_ - 1 || cell.row >= height_ - 1) return false;
  const double z00 = height(cell.column, cell.row), z10 = height(cell.column + 1, cell.row);
  const double z01 = height(cell.column, cell.row + 1), z11 = height(cell.column + 1, cell.row + 1);
  if (std::isnan(z00 + z10 + z01 + z11)) return false;
  const double x0 = cell.column * sx_, y0 = cell.row * sy_;
  const LiteralCell s{
      sx_, sy_, e.x - x0, e.y - y0, e.z, z00, z10 - z00, z01 - z00, (z11 - z01) - (z10 - z00)};
  LiteralBest best;
  scanAlongV(s, best);
  LiteralBest other;
  scanAlongV(s.turned(), other);
  best.keep(other.v, other.u, s);
  // What rounding left beside an edge lies on it.
  const auto onEdge = [](double x) { return std::abs(x - std::round(x)) <= 1e-9 ? std::round(x) : x; };
  const double u = onEdge(best.u), v = onEdge(best.v);
  if (s.distance2(u, v) * (1.0 - 1e-9) <= best.distance2) best = {u, v, s.distance2(u, v)};
  out.cell = cell;
  out.u = best.u;
  out.v = best.v;
  out.position_mm = {x0 + best.u * sx_, y0 + best.v * sy_,
                     s.a + s.b * best.u + (s.c + s.d * best.u) * best.v};
  out.distance2_mm2 = best.distance2;
  return true;
}

LiteralPoint LiteralSearch::from(CellIndex start, const glm::dvec3& e) const {
  LiteralPoint at;
  if (!bounded(start, e, at)) return at;
  for (bool moved = true; moved;) {
    moved = false;
    LiteralPoint nearest = at;
    bool all = true;
    const int across_u = at.u == 0.0 ? -1 : (at.u == 1.0 ? 1 : 0);
    const int across_v = at.v == 0.0 ? -1 : (at.v == 1.0 ? 1 : 0);
    for (int k = 1; k < 4; ++k) {
      if (((k & 1) != 0 && across_u == 0) || ((k & 2) != 0 && across_v == 0)) continue;
      const int du = (k & 1) != 0 ? across_u : 0;
      const int dv = (k & 2) != 0 ? across_v : 0;
      LiteralPoint other;
      if (!bounded({at.cell.column + du, at.cell.row + dv}, e, other)) {
        all = false;
        continue;
      }
      if (!(other.distance2_mm2 < shorter(nearest.distance2_mm2, e))) continue;
      nearest = other;
      moved = true;
    }
    at = nearest;
    at.ringed = all;
  }
  return at;
}

LiteralTracker::LiteralTracker(const engine::Version& field)
    : field_(field), surface_(field_.reader()), search_(field) {}

bool LiteralTracker::touches(const LiteralPoint& point, const glm::dvec3& e) {
  if (point.ringed) return point.position_mm.z > e.z;
  haptic::Contact contact;
  return haptic::contactTest(surface_, {point.cell, point.u, point.v, point.position_mm, point.distance2_mm2},
                             e, counters_, contact);
}

bool LiteralTracker::begins(const glm::dvec3& e, bool below, CellIndex own, LiteralPoint& out) {
  const glm::dvec3 from = has_previous_ ? previous_ : e;
  haptic::RayWalk walk(surface_, from, e);
  haptic::RayCell candidate;
  for (int searches = 0; searches < 16 && walk.next(candidate);) {
    haptic::Patch patch;
    if (!below && (!surface_.patch(candidate.cell, patch) ||
                   !haptic::entersPatch(patch, from, e, candidate.enter, candidate.leave)))
      continue;
    ++searches;
    out = search_.from(candidate.cell, e);
    if (touches(out, e)) return true;
  }
  if (!below) return false;
  out = search_.from(own, e);
  if (touches(out, e)) return true;
  haptic::SurfacePoint closest;
  haptic::Contact contact;
  if (!haptic::certifiedClosest(surface_, e, std::max(surface_.spacingX(), surface_.spacingY()), closest) ||
      !haptic::contactTest(surface_, closest, e, counters_, contact))
    return false;
  out = {closest.cell, closest.u, closest.v, closest.position_mm, closest.distance2_mm2, true};
  return true;
}

bool LiteralTracker::update(const glm::dvec3& e, LiteralPoint& out) {
  CellIndex own;
  haptic::Patch patch;
  bool touches_now = false;
  if (surface_.cellUnder(e, own) && surface_.patch(own, patch)) {
    if (touching_) {
      out = search_.from(cell_, e);
      touches_now = touches(out, e);
    }
    if (!touches_now) touches_now = begins(e, haptic::belowPatch(patch, e), own, out);
  }
  touching_ = touches_now;
  if (touching_) cell_ = out.cell;
  previous_ = e;
  has_previous_ = true;
  return touching_;
}

}  // namespace fettle::bench
