#pragma once

#include <optional>

#include <glm/vec3.hpp>

#include "render/plan/camera.h"

namespace fettle::render {

struct PanelPlan;  // render/plan/plan.h
namespace gpu {
struct Stylus;  // shaders/layout.h
}

/// The stylus as a thing in the scene: a shaded pen whose point is where the tip is, with a ball at it or
/// without, and its shadow on the surface. What the surface hides of it is still seen faintly.
///
/// Height above the surface is read from the shadow: it meets the point where that touches, and moves away,
/// grows soft and fades as the point rises. It falls in the direction of the light (FrameInput).
struct StylusBody {
  glm::dvec3 tip_mm{0.0};       ///< field coordinates; with a ball its centre
  double ball_radius_mm = 0.0;  ///< 0: a point
  /// Direction from the tip to the other end, of any length > 0, in the field's axes; heights are not
  /// exaggerated in it, so that a pen that stands at 45 degrees is seen so. None: usualTail().
  std::optional<glm::dvec3> to_tail{};
  double length_px = 96.0;             ///< at the middle of the picture, > 0
  glm::vec3 colour{1.0F, 1.0F, 1.0F};  ///< of the point and of the ball, linear red, green, blue
  bool shadow = true;
};

/// The direction of a pen held in the right hand of somebody who looks at this picture: up, to the right, and
/// towards the viewer. It always leaves the surface upwards, also from the side. Unit, in the scene.
[[nodiscard]] glm::dvec3 usualTail(const Camera& camera);

/// The body in the scene of a panel, in the layout of the shaders. Empty where a coordinate is not finite.
[[nodiscard]] std::optional<gpu::Stylus> stylusIn(const PanelPlan& panel, const StylusBody& body);

}  // namespace fettle::render
