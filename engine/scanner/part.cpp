#include "engine/scanner/part.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace fettle::engine {

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
