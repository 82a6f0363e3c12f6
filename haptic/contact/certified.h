#pragma once

#include <glm/vec3.hpp>

#include "haptic/contact/patch.h"
#include "haptic/contact/surface.h"

namespace fettle::haptic {

/// The true closest point of a whole patch: every stationary point inside it (at most five, the real roots of
/// a quintic), the closest point of each edge, and with them the vertices. [certified.cpp has the derivation]
[[nodiscard]] PatchPoint closestOnWholePatch(const Patch& patch, const glm::dvec3& endpoint) noexcept;

/// `best`, a point of the patch, or a nearer one of its stationary points.
[[nodiscard]] PatchPoint nearestInside(const Patch& patch, const glm::dvec3& endpoint,
                                       PatchPoint best) noexcept;

/// Whether certainly no point of the patch is nearer than `rest`, where a descent ended, apart from rounding. False where
/// that cannot be told in a few operations. [certified.cpp has the derivation]
[[nodiscard]] bool nothingNearer(const Patch& patch, const glm::dvec3& endpoint,
                                 const PatchPoint& rest) noexcept;

/// Level certified: the true closest point among all cells without holes whose horizontal distance to the
/// endpoint is at most `radius_mm`. It is the closest point of the whole field whenever it is nearer than
/// radius_mm, since everything left out is farther away than that. False when there is no such cell.
///
/// Branch and bound on the min/max pyramid, from squares of 64 cells down: a square is left out when the box
/// around it is not nearer than the best point so far. Of equally near points one is returned, the same for
/// the same input. Error: a few roundings of double arithmetic, relative to distance and heights nearby.
/// Guarantee: noexcept, allocates nothing; at most (2 radius / spacing + 2)^2 cells.
[[nodiscard]] bool certifiedClosest(Surface& surface, const glm::dvec3& endpoint, double radius_mm,
                                    SurfacePoint& out) noexcept;

}  // namespace fettle::haptic
