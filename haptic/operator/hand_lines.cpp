#include "haptic/operator/hand_lines.h"

#include <cmath>
#include <cstddef>

#include "haptic/operator/hand_drift.h"

namespace fettle::haptic {

std::vector<HandLine> handLines(std::span<const engine::Edge> edges, const engine::Grid& grid,
                                const OperatorSpec& spec) {
  std::vector<HandLine> lines;
  for (const engine::Edge& edge : edges) {
    const HandDrift drift(spec.wander_mm, spec.tremor_mm, spec.seed, lines.size() + 1);
    HandLine line;
    line.closed = edge.closed;
    double along = 0.0;
    for (std::size_t i = 0; i < edge.points_mm.size(); ++i) {
      const glm::dvec2 p = edge.points_mm[i];
      if (i > 0) along += std::hypot(p.x - edge.points_mm[i - 1].x, p.y - edge.points_mm[i - 1].y);
      const glm::dvec2 hand = p + drift.at(along / spec.speed_mm_s);
      line.points.emplace_back(hand.x / grid.spacingXMm(), hand.y / grid.spacingYMm());
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace fettle::haptic
