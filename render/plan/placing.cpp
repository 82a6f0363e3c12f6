#include "render/plan/placing.h"

#include <cmath>

#include <glm/geometric.hpp>

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
  const auto length = [&](const glm::dvec3& step) {
    return std::hypot(glm::dot(camera.right(), step), glm::dot(camera.up(), step)) * camera.pixelsPerMm();
  };
  return {length({placing.spacing.x, 0.0, 0.0}), length({0.0, placing.spacing.y, 0.0})};
}

}  // namespace fettle::render
