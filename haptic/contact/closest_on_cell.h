#pragma once

#include <glm/vec3.hpp>

#include "haptic/contact/patch.h"
#include "haptic/contact/surface.h"

namespace fettle::haptic {

/// The bounded closest point: the nearest of all points of the patch, its edges and vertices included. Of equally near
/// ones one is returned, the same for the same input.
///
/// (u0, v0) in [0, 1]^2 is where it probably is: it decides the time, and the result only within rounding. Where the
/// squared distance is convex over the whole patch, Newton's method finds it; where its Hessian is indefinite
/// everywhere, it is the nearest of the closest points of the four edges; else the stationary points are compared unless
/// a descent's end is certainly the nearest.
///
/// Error: a few roundings of double arithmetic, relative to distance and heights. Source: Potter, Johnson, Cohen 2004
/// (DETC2004-57539), "Haptic Rendering". Guarantee: noexcept, allocates nothing.
[[nodiscard]] PatchPoint closestOnCell(const Patch& patch, const glm::dvec3& endpoint, double u0,
                                       double v0) noexcept;

/// The nearest point of the patch's four edges, exact apart from rounding: along an edge squared distance is quadratic.
[[nodiscard]] PatchPoint closestOnEdges(const Patch& patch, const glm::dvec3& endpoint) noexcept;

}  // namespace fettle::haptic
