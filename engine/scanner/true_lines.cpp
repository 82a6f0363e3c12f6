#include "engine/scanner/true_lines.h"

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

}  // namespace fettle::engine
