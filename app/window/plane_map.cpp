// Hartley and Zisserman, Multiple View Geometry (2004), section 2.3 and example 2.12: a homography as the
// product of the two that take the canonical base to either four points.
#include "app/window/plane_map.h"

#include <cmath>

#include <glm/matrix.hpp>

namespace fettle::app {
namespace {

// Maps the base vectors to the first three points and (1, 1, 1) to the fourth, up to a factor.
std::optional<glm::dmat3> fromBase(const std::array<glm::dvec2, 4>& p) {
  const glm::dmat3 corners{glm::dvec3(p[0], 1.0), glm::dvec3(p[1], 1.0), glm::dvec3(p[2], 1.0)};
  const double area = glm::determinant(corners);
  const double size = glm::dot(p[1] - p[0], p[1] - p[0]) + glm::dot(p[2] - p[0], p[2] - p[0]);
  if (!std::isfinite(area) || std::abs(area) <= 1e-9 * size) return std::nullopt;
  const glm::dvec3 weights = glm::inverse(corners) * glm::dvec3(p[3], 1.0);
  for (int i = 0; i < 3; ++i)
    if (!std::isfinite(weights[i]) || std::abs(weights[i]) < 1e-9) return std::nullopt;
  return glm::dmat3{corners[0] * weights[0], corners[1] * weights[1], corners[2] * weights[2]};
}

}  // namespace

std::optional<PlaneMap> PlaneMap::through(const std::array<Pair, 4>& pairs) {
  const auto pixels = fromBase({pairs[0].pixel, pairs[1].pixel, pairs[2].pixel, pairs[3].pixel});
  const auto field = fromBase({pairs[0].field_mm, pairs[1].field_mm, pairs[2].field_mm, pairs[3].field_mm});
  if (!pixels || !field) return std::nullopt;
  const glm::dmat3 map = *field * glm::inverse(*pixels);
  // All four are in front of the viewer, so all have the same sign.
  const double front = (map * glm::dvec3(pairs[0].pixel, 1.0)).z;
  for (const Pair& pair : pairs)
    if (!(front * (map * glm::dvec3(pair.pixel, 1.0)).z > 0.0)) return std::nullopt;
  return PlaneMap(map, front);
}

std::optional<glm::dvec2> PlaneMap::fieldAt(const glm::dvec2& pixel) const {
  const glm::dvec3 p = field_from_pixel_ * glm::dvec3(pixel, 1.0);
  // Far outside the visible part a pixel covers kilometres.
  if (!(p.z * front_ > 1e-9 * front_ * front_)) return std::nullopt;
  return glm::dvec2(p) / p.z;
}

}  // namespace fettle::app
