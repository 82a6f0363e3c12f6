#pragma once

#include <array>

#include <glm/vec3.hpp>

namespace fettle::haptic {

/// The half-space normal . y >= offset; normal of unit length.
struct HalfSpace {
  glm::dvec3 normal;
  double offset;
};

/// Projection of a goal on a set of half-spaces, and its active set.
struct Projection {
  glm::dvec3 y{0.0};
  std::array<int, 3> active{};    ///< half-spaces it rests on, by index
  std::array<double, 3> share{};  ///< > 0: y - goal = sum of share * normal
  int count = 0;                  ///< of active; 0 when the goal is inside
  bool solved = false;  ///< false: round limit reached, or no such point within rounding; y is not usable
};

/// The point of the intersection of `count` half-spaces that is nearest to `goal`, to within `slack` of each.
/// At most kProjectionRounds rounds, each of which adds the half-space violated most and keeps the at most
/// three that are active then; the distance to the goal grows with each round, so no active set repeats.
///
/// Source: Goldfarb and Idnani 1983, "A numerically stable dual method for solving strictly convex quadratic
/// programs", here with the identity as Hessian and every active set of three tried.
/// Guarantee: noexcept, allocates nothing.
[[nodiscard]] Projection projectOnHalfSpaces(const glm::dvec3& goal, const HalfSpace* half_spaces, int count,
                                             double slack) noexcept;

inline constexpr int kProjectionRounds = 48;

}  // namespace fettle::haptic
