#include "engine/scanner/true_lines.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace fettle::engine {

std::vector<EdgeLine> trueLines(const SimulatedScan& scan) {
  const Grid& grid = scan.scan.grid();
  std::vector<EdgeLine> lines;
  for (const Edge& edge : scan.edge_lines) {
    EdgeLine line{static_cast<std::int64_t>(lines.size()), edge.closed, {}};
    for (const glm::dvec2& p : edge.points_mm) {
      EdgePoint point;
      point.position = {p.x / grid.spacingXMm(), p.y / grid.spacingYMm()};
      point.located = true;
      point.kind = edge.kind == EdgeKind::kStep ? LineKind::kStep : LineKind::kCrease;
      line.points.push_back(point);
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

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
