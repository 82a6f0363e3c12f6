#include "engine/scanner/outline.h"

#include <algorithm>
#include <cmath>
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

}  // namespace fettle::engine
