#include "engine/scanner/edge_distance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace fettle::engine {

double distanceFrom(const Edge& edge, glm::dvec2 point_mm) {
  const std::size_t n = edge.points_mm.size();
  double least = std::numeric_limits<double>::infinity();  // squared
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec2 from = edge.points_mm[i];
    const glm::dvec2 to = i + 1 < n ? edge.points_mm[i + 1] : edge.closed ? edge.points_mm[0] : from;
    const glm::dvec2 run = to - from, off = point_mm - from;
    const double length = run.x * run.x + run.y * run.y;
    const double t = length > 0.0 ? std::clamp((off.x * run.x + off.y * run.y) / length, 0.0, 1.0) : 0.0;
    const glm::dvec2 gap = off - run * t;
    least = std::min(least, gap.x * gap.x + gap.y * gap.y);
  }
  return std::sqrt(least);
}

}  // namespace fettle::engine
