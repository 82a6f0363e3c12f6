#pragma once

#include <array>
#include <optional>

#include <glm/vec2.hpp>

#include "app/window/actions.h"
#include "render/plan/camera.h"

namespace fettle::app {

/// The axes of the field as seen, in a corner of the picture: a cross of three lines with a ball at each end. A
/// click on a ball looks from there, with the action of the key that does the same. Pure geometry; drawn by
/// panels/axes_overlay.cpp. Pixels of the window's frame.
class AxesGizmo {
 public:
  struct Ball {
    int axis = 0;  ///< 0 x, 1 y, 2 z
    bool positive = true;
    std::optional<Action> action;  ///< looks from there; nothing from below, where a height field has no side
    glm::dvec2 at{0.0};
    double nearer = 0.0;  ///< towards the viewer, -1 .. 1: near ones are drawn over far ones
  };

  /// In the upper right corner of a plot; no balls where that is too small for both. `scale`: of the display.
  AxesGizmo(const render::View& view, const render::Rectangle& plot, double scale);

  [[nodiscard]] bool shown() const noexcept { return shown_; }
  /// From far to near.
  [[nodiscard]] const std::array<Ball, 6>& balls() const noexcept { return balls_; }
  [[nodiscard]] const glm::dvec2& middle() const noexcept { return middle_; }
  [[nodiscard]] double ballRadius() const noexcept { return ball_radius_; }
  /// The ball that a click at this place means: the nearest of those that can be clicked on.
  [[nodiscard]] const Ball* under(const glm::dvec2& place) const noexcept;

 private:
  bool shown_ = false;
  std::array<Ball, 6> balls_;
  glm::dvec2 middle_{0.0};
  double ball_radius_ = 0.0;
};

}  // namespace fettle::app
