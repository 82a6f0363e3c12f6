#pragma once

#include <glm/vec3.hpp>

#include "haptic/contact/surface.h"

namespace fettle::haptic {

/// A point of a patch and its squared distance to the endpoint [mm^2].
struct PatchPoint {
  double u = 0.0, v = 0.0;
  double distance2_mm2 = 0.0;
};

/// The bounded local closest point: where a descent of the distance from (u0, v0) in [0, 1]^2 ends within the
/// patch. Newton's method while the Hessian is positive definite and the point stays inside, else the exact
/// minimum along one parameter at a time (distance is quadratic in u alone and in v alone). Points on edges
/// have u or v exactly 0 or 1. Never farther than the start, apart from rounding; at most kNewtonSteps
/// rounds.
///
/// Source: Potter, Johnson, Cohen 2004, "Height field haptics"; active set on a box as in Nocedal and Wright,
/// "Numerical Optimization" (2006), section 16.7. Guarantee: wait-free, noexcept, allocates nothing.
[[nodiscard]] PatchPoint closestOnPatch(const Patch& patch, const glm::dvec3& endpoint, double u0,
                                        double v0) noexcept;

inline constexpr int kNewtonSteps = 60;

}  // namespace fettle::haptic
