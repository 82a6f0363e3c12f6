#pragma once

#include <algorithm>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "haptic/contact/surface.h"

namespace fettle::haptic {

/// A lower bound of the squared distance to the patch, from its extent along `away`, a direction from some
/// point to the endpoint, not zero: a patch lies in the hull of its corners, and so no nearer than the nearest
/// of their four planes across that direction. Off by a few roundings of the heights nearby.
[[nodiscard, gnu::always_inline]] inline double hullDistance2(const Patch& s, const glm::dvec3& e,
                                                              const glm::dvec3& away) noexcept {
  const double along_u = away.x * s.sx + away.z * s.b;
  const double along_v = away.y * s.sy + away.z * s.c;
  const double nearest = away.x * (e.x - s.x0) + away.y * (e.y - s.y0) + away.z * (e.z - s.a) -
                         std::max({0.0, along_u, along_v, along_u + along_v + away.z * s.d});
  return nearest > 0.0 ? nearest * nearest / glm::dot(away, away) : 0.0;
}

/// Scalar products with `away` of the ways from the patch's point at (u, v) to its corners: the largest.
[[nodiscard, gnu::always_inline]] inline double highestRise(const Patch& s, const glm::dvec3& away, double u,
                                                            double v) noexcept {
  const double along_u = away.x * s.sx + away.z * s.b;
  const double along_v = away.y * s.sy + away.z * s.c;
  const double twist = away.z * s.d;
  return std::max(std::max(0.0, along_u), std::max(along_v, along_u + along_v + twist)) -
         (u * along_u + v * along_v + u * v * twist);
}

}  // namespace fettle::haptic
