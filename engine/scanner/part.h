#pragma once

#include <string_view>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/scanner/scanner.h"

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

/// Effect of a feature inside its outline.
enum class FeatureKind {
  kSet,      ///< the height becomes `level` + slope . p + waviness: boss, pocket, rib, freeform pad
  kThrough,  ///< no surface: a through hole
  kRoof,     ///< added: a ridge along the outline's u axis, falling by `slope_v` to nothing at its sides
  kBump,     ///< added: a smooth bump, level * (1 - t^2)^3 with t = 1 at the outline (C2, no edge)
};

/// How the border of a feature is broken.
enum class Rim {
  kSharp,    ///< a vertical wall at the outline
  kChamfer,  ///< a bevel `rim_mm` wide inside the outline at 45 degrees; a raised feature's from its top
             ///< down, a sunk feature's from the surroundings down
  kFillet,   ///< a quarter circle of radius `rim_mm` from the top down (raised features only)
};

/// One operation on the height of the features below it. Corner radii are at least rim_mm where there is a
/// rim, so that bevels meet without mitre lines and the listed edges are all there are.
struct Feature {
  FeatureKind kind = FeatureKind::kSet;
  Outline outline;
  double level = 0.0;       ///< [mm], kSet and kBump
  glm::dvec2 slope{0, 0};   ///< tilt of a kSet surface about the outline's centre [mm/mm]
  double waviness = 0.0;    ///< amplitude of a smooth freeform relief on a kSet surface [mm]
  double wavelength = 1.0;  ///< of that relief [mm]
  double slope_v = 0.0;     ///< kRoof: fall per mm away from the u axis; negative = a groove
  Rim rim = Rim::kSharp;
  double rim_mm = 0.0;
  bool sunk = false;     ///< kSet: the rim falls from the surroundings; kThrough: countersink of rim_mm
  double foot_mm = 0.0;  ///< raised kSet: radius of the concave fillet outside the wall's foot, 0 = none
};

/// A part: features placed over each other on a plane at height 0. All in millimetres, origin in the middle.
struct Part {
  PartInfo info;
  std::vector<Feature> features;

  /// Exact height at p [mm], NaN in a through hole. On an outline itself the inside counts.
  [[nodiscard]] double heightAt(glm::dvec2 p) const noexcept;
  /// The same over a subset of the features (in order), for a caller that knows which ones reach p.
  [[nodiscard]] static double heightAt(glm::dvec2 p, const std::vector<const Feature*>& features) noexcept;
  /// The features that can reach into a circle.
  [[nodiscard]] std::vector<const Feature*> near(glm::dvec2 centre, double radius) const;
};

/// The part of that name, or null. Valid for the life of the program.
[[nodiscard]] const Part* findPart(std::string_view name) noexcept;

/// Steps lower than this [mm] and slope jumps smaller than this [mm/mm] are not called edges.
inline constexpr double kLeastEdge = 0.05;

/// The lines of the part where its surface has a jump or a crease: every outline and bevel line, cut to where
/// the finished surface differs on its two sides, since later features may have removed it. A through hole's
/// rim is not one: it has no height on one side. Points at most `step` apart [mm], moved by `shift` and
/// clipped to [0, extent] in both axes.
[[nodiscard]] std::vector<Edge> edgesOf(const Part& part, double step, glm::dvec2 shift, glm::dvec2 extent);

}  // namespace fettle::engine
