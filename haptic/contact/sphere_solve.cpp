#include "haptic/contact/sphere_solve.h"

#include <cmath>

#include <glm/geometric.hpp>

namespace fettle::haptic {

namespace {

// Half-spaces nearer to parallel than this (squared sine) count as one.
constexpr double kParallel = 1e-14;

struct Trial {
  glm::dvec3 y{0.0};
  std::array<double, 3> share{};
};

// The point nearest to the goal on the planes `set`; false when they are parallel or one of them would pull.
bool onPlanes(const glm::dvec3& goal, const HalfSpace* h, const int* set, int n, Trial& out) noexcept {
  std::array<double, 3> lack{};
  for (int k = 0; k < n; ++k) lack[k] = h[set[k]].offset - glm::dot(h[set[k]].normal, goal);
  if (n == 1) {
    if (!(lack[0] >= 0.0)) return false;
    out.share[0] = lack[0];
    out.y = goal + lack[0] * h[set[0]].normal;
    return true;
  }
  const glm::dvec3& n0 = h[set[0]].normal;
  const glm::dvec3& n1 = h[set[1]].normal;
  const glm::dvec3 across = glm::cross(n0, n1);
  if (n == 2) {
    const double det = glm::dot(across, across);
    if (!(det > kParallel)) return false;
    const double g = glm::dot(n0, n1);
    out.share[0] = (lack[0] - g * lack[1]) / det;
    out.share[1] = (lack[1] - g * lack[0]) / det;
    if (!(out.share[0] >= 0.0 && out.share[1] >= 0.0)) return false;
    out.y = goal + out.share[0] * n0 + out.share[1] * n1;
    return true;
  }
  const glm::dvec3& n2 = h[set[2]].normal;
  const double volume = glm::dot(across, n2);
  if (!(volume * volume > kParallel)) return false;
  // The three planes meet in a point; its offset from the goal, in terms of the normals.
  const glm::dvec3 a = glm::cross(n1, n2) / volume;
  const glm::dvec3 b = glm::cross(n2, n0) / volume;
  const glm::dvec3 c = across / volume;
  const glm::dvec3 step = lack[0] * a + lack[1] * b + lack[2] * c;
  out.share = {glm::dot(a, step), glm::dot(b, step), glm::dot(c, step)};
  if (!(out.share[0] >= 0.0 && out.share[1] >= 0.0 && out.share[2] >= 0.0)) return false;
  out.y = goal + step;
  return true;
}

}  // namespace

Projection projectOnHalfSpaces(const glm::dvec3& goal, const HalfSpace* h, int count, double slack) noexcept {
  Projection at;
  at.y = goal;
  for (int round = 0; round < kProjectionRounds; ++round) {
    int worst = -1;
    double most = slack;
    for (int i = 0; i < count; ++i) {
      const double lack = h[i].offset - glm::dot(h[i].normal, at.y);
      if (lack > most) {
        most = lack;
        worst = i;
      }
    }
    if (worst < 0) {
      at.solved = true;
      return at;
    }
    // The new half-space is active, together with none, one, two or three of those active before; the first
    // combination that satisfies the others is the answer for all four, because it is unique.
    Trial best;
    int best_set[3] = {worst, 0, 0};
    int best_n = 0;
    double least = HUGE_VAL;
    const auto attempt = [&](int n, int first, int second) {
      const int set[3] = {worst, n > 1 ? at.active[static_cast<std::size_t>(first)] : 0,
                          n > 2 ? at.active[static_cast<std::size_t>(second)] : 0};
      Trial trial;
      if (!onPlanes(goal, h, set, n, trial)) return;
      double lack = 0.0;
      for (int k = 0; k < at.count; ++k) {
        const HalfSpace& other = h[at.active[static_cast<std::size_t>(k)]];
        const double l = other.offset - glm::dot(other.normal, trial.y);
        lack = l > lack ? l : lack;
      }
      if (lack < least) {
        least = lack;
        best = trial;
        best_n = n;
        best_set[1] = set[1];
        best_set[2] = set[2];
      }
    };
    attempt(1, 0, 0);
    for (int k = 0; k < at.count && least > slack; ++k) attempt(2, k, 0);
    for (int k = 0; k < at.count && least > slack; ++k)
      for (int m = k + 1; m < at.count && least > slack; ++m) attempt(3, k, m);
    if (best_n == 0) return at;
    at.y = best.y;
    at.count = best_n;
    for (int k = 0; k < best_n; ++k) {
      at.active[static_cast<std::size_t>(k)] = best_set[k];
      at.share[static_cast<std::size_t>(k)] = best.share[static_cast<std::size_t>(k)];
    }
  }
  return at;
}

}  // namespace fettle::haptic
