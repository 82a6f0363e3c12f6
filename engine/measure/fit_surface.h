#pragma once

#include <glm/vec3.hpp>

#include "engine/measure/fit_shape.h"

namespace fettle::engine {

/// Plane, sphere, cylinder, cone and torus as one family, described at a point of the surface: a part of a torus of any
/// size. Unlike centre and radius these numbers stay determined where a small part of a large shape was measured, and a
/// curvature may pass through 0. After G. Lukacs, R. Martin, D. Marshall, Faithful least-squares fitting of spheres,
/// cylinders, cones and tori for reliable segmentation (1998), who use distances that are right to first order for the
/// cone and the torus; here they are exact, and the torus is described by the distance of the foot from its axis, so that
/// the top of a ring, where the normal is parallel to the axis, is no special case.
///
///   foot     q, a point of the surface
///   axial    a, direction of the axis
///   radial   e, across it: the axis passes through q - e / ring
///   theta    normal n = a sin theta - e cos theta, upwards
///   ring     1 / distance of the foot from the axis; 0: the axis is infinitely far away
///   tube     curvature of the section with the plane through the axis: its centre is q + n / tube; 0: a straight line
struct FitSurface {
  glm::dvec3 foot{0.0}, radial{0.0, 0.0, -1.0}, axial{1.0, 0.0, 0.0};
  double theta = 0.0, ring = 0.0, tube = 0.0;

  [[nodiscard]] glm::dvec3 normal() const noexcept;

  /// Signed orthogonal distance, above 0 where the point is above the surface, and how it follows the point and the numbers.
  struct At {
    double distance = 0.0;
    glm::dvec3 gradient{0.0};  ///< by the point; of length 1
    double by_theta = 0.0, by_ring = 0.0, by_tube = 0.0;
  };
  [[nodiscard]] At at(const glm::dvec3& point) const noexcept;

  /// The shape as a member of the family, with its foot below or above `near`.
  [[nodiscard]] static FitSurface of(const Shape& shape, const glm::dvec3& near) noexcept;
  /// The shape of a kind that these numbers describe; its point on an axis is that nearest to `middle`, on a plane that
  /// above or below it; an axis without a sense points as `alike` does.
  [[nodiscard]] Shape shape(ShapeKind kind, const glm::dvec3& middle, const glm::dvec3& alike) const noexcept;
};

}  // namespace fettle::engine
