#include "render/plan/placing.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace fettle::render {

Placing placingOf(const engine::Grid& grid) {
  Placing p;
  p.true_size = {grid.width, grid.height};
  p.size = glm::max(p.true_size, glm::ivec2(2));
  p.spacing = {grid.spacingXMm(), grid.spacingYMm()};
  p.first = -0.5 * p.extent();
  return p;
}

glm::dvec2 cellPixels(const Placing& placing, const Camera& camera) {
  // From the side a step into the picture has no length, and nothing is to be divided by it: as seen from at
  // least three degrees above the horizon.
  constexpr double kLeastSine = 0.05233595624294383;
  const double rises = camera.toViewer().z;  // the sine of the elevation
  const glm::dvec3 away{-camera.right().y, camera.right().x, 0.0};
  const glm::dvec3 up = rises < kLeastSine ? kLeastSine * away : camera.up();
  const auto length = [&](const glm::dvec3& step) {
    return std::hypot(glm::dot(camera.right(), step), glm::dot(up, step)) * camera.pixelsPerMm();
  };
  return {length({placing.spacing.x, 0.0, 0.0}), length({0.0, placing.spacing.y, 0.0})};
}

gpu::ViewUniforms viewOf(const Camera& camera, const Placing& placing, const Rectangle& plot) {
  // Columns: the results of x, y, depth and 1.
  glm::dmat4 clip_from_pixel(1.0);
  clip_from_pixel[0][0] = 2.0 / plot.width;
  clip_from_pixel[1][1] = 2.0 / plot.height;
  clip_from_pixel[3] = {-1.0 - 2.0 * plot.x / plot.width, -1.0 - 2.0 * plot.y / plot.height, 0.0, 1.0};
  glm::dmat4 samples_from_scene(1.0);
  samples_from_scene[0][0] = 1.0 / placing.spacing.x;
  samples_from_scene[1][1] = 1.0 / placing.spacing.y;
  samples_from_scene[3] = {-placing.first.x / placing.spacing.x, -placing.first.y / placing.spacing.y, 0.0,
                           1.0};
  glm::dmat4 back = samples_from_scene * glm::inverse(camera.clipFromScene()) * clip_from_pixel;

  // The middle of the plot, halfway in depth: in pixels, everything visible is near it.
  const glm::dvec4 middle =
      back * glm::dvec4(plot.x + 0.5 * plot.width, plot.y + 0.5 * plot.height, 0.5, 1.0);
  const auto nearest = [&](double p, int size) {
    const double s = std::round(p);
    return static_cast<int>(std::isfinite(s) ? std::clamp(s, 0.0, static_cast<double>(size - 1)) : 0.0);
  };
  const glm::ivec2 origin(nearest(middle.x / middle.w, placing.size.x),
                          nearest(middle.y / middle.w, placing.size.y));
  for (int c = 0; c < 4; ++c) {
    back[c].x -= origin.x * back[c].w;
    back[c].y -= origin.y * back[c].w;
  }
  gpu::ViewUniforms view{};
  view.clip_from_scene = glm::mat4(camera.clipFromScene());
  view.field_from_pixel = glm::mat4(back);
  view.origin = glm::ivec4(origin, 0, 0);
  return view;
}

}  // namespace fettle::render
