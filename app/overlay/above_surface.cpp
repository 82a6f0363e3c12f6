#include "app/overlay/above_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace fettle::app {

glm::dvec3 aboveSurface(const engine::FieldReader& reader, glm::dvec2 at) {
  const engine::Grid& grid = reader.grid();
  const auto clamped = [](double v, std::int32_t side) {
    return static_cast<std::int32_t>(std::clamp(v, 0.0, side - 1.0));
  };
  double height = -std::numeric_limits<double>::infinity();
  for (const double dr : {-1.0, 0.0, 1.0, 2.0})
    for (const double dc : {-1.0, 0.0, 1.0, 2.0}) {
      const float z = reader.heightAt(clamped(std::floor(at.x + dc), grid.width),
                                      clamped(std::floor(at.y + dr), grid.height));
      if (z > height) height = static_cast<double>(z);
    }
  if (!std::isfinite(height)) height = 0.0;
  return {at.x * grid.spacingXMm(), at.y * grid.spacingYMm(), height * grid.height_unit.mm};
}

}  // namespace fettle::app
