#pragma once

#include <vector>

#include <glm/vec2.hpp>

namespace fettle::engine {

/// A closed convex line in the plane of the part [mm]: a rectangle with round corners, turned by an angle.
/// All outlines of machined parts are special cases: a circle (half = radius in both directions), a slot
/// (radius = half_width), a sharp-cornered rectangle (radius = 0). One formula gives the exact signed
/// distance of all of them, and an inner parallel is again such an outline.
struct Outline {
  glm::dvec2 centre{0.0, 0.0};
  double half_length = 1.0;    ///< along the outline's own u axis [mm], > 0
  double half_width = 1.0;     ///< along v [mm], > 0
  double radius = 0.0;         ///< of the corners [mm], 0 .. min(half_length, half_width)
  glm::dvec2 along{1.0, 0.0};  ///< unit vector of the u axis; v lies 90 degrees counter-clockwise of it

  [[nodiscard]] static Outline circle(glm::dvec2 centre, double radius) {
    return {centre, radius, radius, radius, {1.0, 0.0}};
  }

  /// The same, turned counter-clockwise about its centre by an angle in degrees.
  [[nodiscard]] Outline rotated(double degrees) const noexcept;

  /// p in the outline's own axes, from its centre.
  [[nodiscard]] glm::dvec2 toLocal(glm::dvec2 p) const noexcept;
  /// A direction in the outline's own axes, in those of the part.
  [[nodiscard]] glm::dvec2 turned(glm::dvec2 own) const noexcept;

  /// Euclidean distance of p to the line, < 0 inside [mm]; exact apart from rounding, for convex corners too.
  /// Source of the formula: Quilez, "2D distance functions", rounded box.
  [[nodiscard]] double distance(glm::dvec2 p) const noexcept;

  /// The parallel line `by` inside this one [mm], 0 <= by < min(half_length, half_width).
  [[nodiscard]] Outline inset(double by) const noexcept;

  /// Radius of the smallest circle about the centre that contains the line [mm].
  [[nodiscard]] double reach() const noexcept;

  struct Point {
    glm::dvec2 position;  ///< on the line
    glm::dvec2 outward;   ///< unit normal; at a sharp corner the bisector
  };
  /// Points counter-clockwise along the line, at most `step` apart [mm, > 0]; the first is not repeated.
  [[nodiscard]] std::vector<Point> points(double step) const;
};

}  // namespace fettle::engine
