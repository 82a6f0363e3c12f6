#include "engine/scanner/part.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace fettle::engine {

Outline Outline::rotated(double degrees) const noexcept {
  const double radians = degrees * std::numbers::pi / 180.0;
  Outline other = *this;
  other.along = turned({std::cos(radians), std::sin(radians)});
  return other;
}

glm::dvec2 Outline::toLocal(glm::dvec2 p) const noexcept {
  const glm::dvec2 q = p - centre;
  return {along.x * q.x + along.y * q.y, along.x * q.y - along.y * q.x};
}

glm::dvec2 Outline::turned(glm::dvec2 own) const noexcept {
  return {along.x * own.x - along.y * own.y, along.y * own.x + along.x * own.y};
}

double Outline::distance(glm::dvec2 p) const noexcept {
  const glm::dvec2 own = toLocal(p);
  const double qx = std::abs(own.x) - half_length + radius;
  const double qy = std::abs(own.y) - half_width + radius;
  const double ox = std::max(qx, 0.0);
  const double oy = std::max(qy, 0.0);
  return std::sqrt(ox * ox + oy * oy) + std::min(std::max(qx, qy), 0.0) - radius;
}

Outline Outline::inset(double by) const noexcept {
  Outline inner = *this;
  inner.half_length -= by;
  inner.half_width -= by;
  inner.radius = std::max(radius - by, 0.0);
  return inner;
}

double Outline::reach() const noexcept {
  return std::hypot(half_length - radius, half_width - radius) + radius;
}

std::vector<Outline::Point> Outline::points(double step) const {
  std::vector<Point> line;
  const double a = half_length - radius;
  const double b = half_width - radius;
  // Corner centres counter-clockwise from the upper right; corner k's arc spans k * 90 to (k + 1) * 90
  // degrees.
  const glm::dvec2 corners[4] = {{a, b}, {-a, b}, {-a, -b}, {a, -b}};
  const auto add = [&](glm::dvec2 own, glm::dvec2 outward) {
    line.push_back({centre + turned(own), turned(outward)});
  };
  for (int k = 0; k < 4; ++k) {
    const double from = k * std::numbers::pi / 2;
    const int steps =
        radius > 0.0 ? std::max(1, static_cast<int>(std::ceil(radius * std::numbers::pi / 2 / step))) : 0;
    for (int i = 0; i <= steps; ++i) {
      const double t = steps > 0 ? from + std::numbers::pi / 2 * i / steps : from + std::numbers::pi / 4;
      const glm::dvec2 outward{std::cos(t), std::sin(t)};
      add(corners[k] + radius * outward, outward);
    }
    const glm::dvec2 side{std::cos(from + std::numbers::pi / 2), std::sin(from + std::numbers::pi / 2)};
    const glm::dvec2 start = corners[k] + radius * side;
    const glm::dvec2 run = corners[(k + 1) % 4] - corners[k];
    const double length = std::sqrt(run.x * run.x + run.y * run.y);
    const int pieces = static_cast<int>(std::ceil(length / step));
    // The end of the side is the next corner's first point; without a side (circle, slot) the corner's last
    // point is already that one.
    for (int i = 1; i < pieces; ++i) add(start + run * (static_cast<double>(i) / pieces), side);
    if (radius > 0.0 && pieces == 0) line.pop_back();
  }
  return line;
}

namespace {

constexpr double kHole = std::numeric_limits<double>::quiet_NaN();

// A smooth relief without a common period along x and y; within +-1.
double relief(glm::dvec2 p, double wavelength) noexcept {
  const double k = 2.0 * std::numbers::pi / wavelength;
  return 0.5 * std::sin(k * p.x) * std::cos(0.7 * k * p.y) +
         0.5 * std::sin(0.43 * k * (p.x + 1.7 * p.y) + 1.0);
}

double surfaceOf(const Feature& f, glm::dvec2 p) noexcept {
  const glm::dvec2 q = p - f.outline.centre;
  double z = f.level + f.slope.x * q.x + f.slope.y * q.y;
  if (f.waviness != 0.0) z += f.waviness * relief(q, f.wavelength);
  return z;
}

// Height over its start at distance x from the tangent point of a quarter circle: 0 at x = 0, r at x = r.
double quarterCircle(double x, double r) noexcept {
  return r - std::sqrt(std::max(0.0, (r - x) * (r + x)));
}

double set(const Feature& f, glm::dvec2 p, double below, double d) noexcept {
  if (d > 0.0) return d < f.foot_mm ? below + quarterCircle(f.foot_mm - d, f.foot_mm) : below;
  const double inside = -d;
  if (f.rim == Rim::kSharp || inside >= f.rim_mm) return surfaceOf(f, p);
  if (f.sunk) return below - inside;  // 45 degrees
  const double from_top = f.rim_mm - inside;
  return surfaceOf(f, p) - (f.rim == Rim::kChamfer ? from_top : quarterCircle(from_top, f.rim_mm));
}

double through(const Feature& f, double below, double d) noexcept {
  if (d > 0.0) return below;
  return -d < f.rim_mm ? below + d : kHole;
}

double applied(const Feature& f, glm::dvec2 p, double below) noexcept {
  const double d = f.outline.distance(p);
  switch (f.kind) {
    case FeatureKind::kSet:
      return set(f, p, below, d);
    case FeatureKind::kThrough:
      return through(f, below, d);
    case FeatureKind::kRoof:
      if (d > 0.0) return below;
      return below + f.slope_v * (f.outline.half_width - std::abs(f.outline.toLocal(p).y));
    case FeatureKind::kBump: {
      if (d >= 0.0) return below;
      const double t = 1.0 + d / std::min(f.outline.half_length, f.outline.half_width);
      const double s = 1.0 - t * t;
      return below + f.level * s * s * s;
    }
  }
  return below;
}

}  // namespace

double Part::heightAt(glm::dvec2 p, const std::vector<const Feature*>& features) noexcept {
  double z = 0.0;
  for (const Feature* f : features) z = applied(*f, p, z);
  return z;
}

double Part::heightAt(glm::dvec2 p) const noexcept {
  double z = 0.0;
  for (const Feature& f : features) z = applied(f, p, z);
  return z;
}

std::vector<const Feature*> Part::near(glm::dvec2 centre, double radius) const {
  std::vector<const Feature*> found;
  for (const Feature& f : features) {
    const glm::dvec2 apart = f.outline.centre - centre;
    // A margin of a thousandth, for rounding of the sum.
    if (std::hypot(apart.x, apart.y) <= (f.outline.reach() + f.foot_mm + radius) * 1.001) found.push_back(&f);
  }
  return found;
}

}  // namespace fettle::engine
