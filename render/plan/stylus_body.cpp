#include "render/plan/stylus_body.h"

#include <cmath>

#include <glm/geometric.hpp>

#include "render/plan/plan.h"

namespace fettle::render {
namespace {

// Of the pen's length: its radius, and where its shadow ends.
constexpr double kPenRadius = 0.065, kShadowReach = 3.0;
// Along up, the picture's right and the viewer's side of the ground.
constexpr glm::dvec3 kHeld{0.8, 0.45, 0.3};

bool isFinite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

glm::dvec3 usualTail(const Camera& camera) {
  const glm::dvec3& right = camera.right();
  // On the ground towards the viewer; from above, to the lower edge of the picture.
  const glm::dvec3 nearer{right.y, -right.x, 0.0};
  return glm::normalize(kHeld.x * glm::dvec3(0.0, 0.0, 1.0) + kHeld.y * right + kHeld.z * nearer);
}

std::optional<gpu::Stylus> stylusIn(const PanelPlan& panel, const StylusBody& body) {
  const glm::dvec3 tail = body.to_tail.value_or(usualTail(panel.camera));
  const double mm_per_px = 1.0 / panel.camera.pixelsPerMm();
  const double length = body.length_px * mm_per_px, tail_length = glm::length(tail);
  if (!isFinite(body.tip_mm) || !isFinite(tail) || !(tail_length > 0.0) || !std::isfinite(length))
    return std::nullopt;
  const glm::dvec3 along = tail / tail_length;
  const glm::dvec3 centre = inScene(panel, body.tip_mm);
  // Heights may be exaggerated: a ball is an ellipsoid then, which touches where the ball does.
  const double unit_mm = panel.field.grid().height_unit.mm;
  const glm::dvec3 radii = body.ball_radius_mm * glm::dvec3(1.0, 1.0, panel.mm_per_unit / unit_mm);
  glm::dvec3 point = centre;
  if (body.ball_radius_mm > 0.0) point += along / glm::length(along / radii);
  const bool ball_is_nearer = panel.camera.depthOf(centre) < panel.camera.depthOf(point);
  gpu::Stylus out;
  out.point = glm::vec4(glm::vec3(point), panel.floor_z);
  out.tail = glm::vec4(glm::vec3(point + length * along), kPenRadius * length);
  out.ball = glm::vec4(glm::vec3(centre), radii.z);
  out.colour = glm::vec4(body.colour, ball_is_nearer ? 1.0F : 0.0F);
  out.shadow = glm::vec4(body.shadow ? 1.0 : 0.0, kShadowReach * length, mm_per_px, radii.x);
  return out;
}

}  // namespace fettle::render
