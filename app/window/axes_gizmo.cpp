#include "app/window/axes_gizmo.h"

#include <algorithm>

#include <glm/geometric.hpp>

namespace fettle::app {
namespace {

// [pixels at scale 1]
constexpr double kArm = 32.0, kBall = 9.0, kFromCorner = 48.0;
constexpr double kSmallestPlot = 3.0 * kFromCorner;

constexpr std::array<std::optional<Action>, 6> kLooks{Action::kViewRight, Action::kViewLeft,
                                                      Action::kViewBack,  Action::kViewFront,
                                                      Action::kViewTop,   std::nullopt};

}  // namespace

AxesGizmo::AxesGizmo(const render::View& view, const render::Rectangle& plot, double scale)
    : shown_(std::min(plot.width, plot.height) >= kSmallestPlot * scale),
      middle_(plot.x + plot.width - kFromCorner * scale, plot.y + kFromCorner * scale),
      ball_radius_(kBall * scale) {
  const render::ViewAxes axes = render::axesOf(view);
  for (int i = 0; i < 6; ++i) {
    const int axis = i / 2;
    const double sign = i % 2 == 0 ? 1.0 : -1.0;
    Ball& ball = balls_[static_cast<std::size_t>(i)];
    ball.axis = axis;
    ball.positive = i % 2 == 0;
    ball.action = kLooks[static_cast<std::size_t>(i)];
    // The picture's rows run down.
    ball.at = middle_ + sign * kArm * scale * glm::dvec2(axes.right[axis], -axes.up[axis]);
    ball.nearer = sign * axes.to_viewer[axis];
  }
  std::stable_sort(balls_.begin(), balls_.end(),
                   [](const Ball& a, const Ball& b) { return a.nearer < b.nearer; });
}

const AxesGizmo::Ball* AxesGizmo::under(const glm::dvec2& place) const noexcept {
  const Ball* found = nullptr;
  if (!shown_) return found;
  // Of two behind each other the near one, which comes later.
  for (const Ball& ball : balls_)
    if (ball.action && glm::distance(place, ball.at) <= ball_radius_) found = &ball;
  return found;
}

}  // namespace fettle::app
