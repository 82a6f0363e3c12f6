#include "render/plan/level_of_detail.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace fettle::render {
namespace {

// Whether some sample of [column, column + columns] x [row, row + rows], both ends in, may hold a height:
// exact up to the squares of the pyramid, which are chosen about as large as the rectangle.
bool anyHeight(const engine::FieldReader& reader, glm::ivec2 first, glm::ivec2 extent) {
  int level = 0;
  std::int32_t side = engine::kBlockSide;
  while (side < std::max(extent.x, extent.y) / 4 && level <= reader.topLevel()) {
    side *= 8;
    ++level;
  }
  const std::int32_t last_column = std::min(first.x + extent.x, reader.width() - 1);
  const std::int32_t last_row = std::min(first.y + extent.y, reader.height() - 1);
  for (std::int32_t y = std::min(first.y, last_row) / side; y <= last_row / side; ++y)
    for (std::int32_t x = std::min(first.x, last_column) / side; x <= last_column / side; ++x)
      if (!reader.bounds(level, x, y).empty()) return true;
  return false;
}

}  // namespace

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

Detail chooseDetail(const engine::Version& field, const Placing& placing, const Camera& camera,
                    double cell_px, double low_z, double high_z) {
  Detail detail;
  const glm::dvec2 px = cellPixels(placing, camera);
  for (int axis = 0; axis < 2; ++axis) {
    int& k = detail.log2_stride[axis];
    // A stride past the field's own size would only draw the same two vertices.
    while (k < 17 && px[axis] * std::ldexp(1.0, k) < cell_px && (1 << k) < placing.size[axis] - 1) ++k;
  }
  const glm::ivec2 stride{1 << detail.log2_stride.x, 1 << detail.log2_stride.y};
  const glm::ivec2 span = stride * gpu::kPatchCells;
  const glm::ivec2 count = (placing.size - 2) / span + 1;
  const engine::FieldReader reader = field.reader();
  const auto boxOf = [&](glm::ivec2 first, glm::ivec2 last) {
    const glm::dvec2 a = placing.first + placing.spacing * glm::dvec2(first);
    const glm::dvec2 b = placing.first + placing.spacing * glm::dvec2(glm::min(last, placing.size - 1));
    return Box{{a.x, a.y, low_z}, {b.x, b.y, high_z}};
  };
  for (int y = 0; y < count.y; ++y)
    for (int x = 0; x < count.x; ++x) {
      const glm::ivec2 first = glm::ivec2(x, y) * span;
      if (!anyHeight(reader, first, span) || camera.misses(boxOf(first, first + span))) continue;
      const glm::ivec4 place{first.x, first.y, detail.log2_stride.x, detail.log2_stride.y};
      detail.patches.push_back({place});
      const auto wall = [&](glm::ivec2 from, int side) {
        detail.walls.push_back({{from.x, from.y, place.z, place.w | side << 8}});
      };
      if (y == 0) wall(first, 0);
      if (x == count.x - 1) wall({placing.size.x - 1, first.y}, 1);
      if (y == count.y - 1) wall({first.x, placing.size.y - 1}, 2);
      if (x == 0) wall(first, 3);
    }
  return detail;
}

}  // namespace fettle::render
