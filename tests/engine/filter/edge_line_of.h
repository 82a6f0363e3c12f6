#pragma once

#include <cmath>
#include <vector>

#include <glm/geometric.hpp>

#include "engine/field/edge_line.h"

namespace fettle::engine::tests {

/// The located line of a step along some corners, with points half a sample apart.
inline EdgeLine edgeLineOf(const std::vector<glm::dvec2>& corners, double deviation = 0.0) {
  EdgeLine line;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec2 to = i + 1 < corners.size() ? corners[i + 1] : corners[i];
    const int steps =
        i + 1 < corners.size() ? static_cast<int>(std::ceil(2.0 * glm::distance(corners[i], to))) : 1;
    for (int k = 0; k < steps; ++k) {
      EdgePoint point;
      point.position = corners[i] + (to - corners[i]) * (static_cast<double>(k) / steps);
      point.located = true;
      point.deviation = deviation;
      line.points.push_back(point);
    }
  }
  return line;
}

}  // namespace fettle::engine::tests
