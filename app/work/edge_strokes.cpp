#include "app/work/edge_strokes.h"

#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

namespace fettle::app {

constexpr double kMeets = 3.0, kLeastClosed = 30.0;  // [samples]

bool isClosedStroke(std::span<const glm::dvec2> points) {
  if (points.empty()) return false;
  double length = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) length += glm::distance(points[i - 1], points[i]);
  return length >= kLeastClosed && glm::distance(points.front(), points.back()) <= kMeets;
}

std::vector<engine::EdgeStroke> edgeStrokesOf(std::span<const haptic::StrokeSample> session,
                                              const engine::Grid& grid) {
  std::vector<engine::EdgeStroke> strokes;
  engine::EdgeStroke stroke;
  const auto end = [&] {
    if (stroke.points.size() > 1) {
      stroke.id = static_cast<std::int64_t>(strokes.size());
      stroke.closed = isClosedStroke(stroke.points);
      strokes.push_back(std::move(stroke));
    }
    stroke = {};
  };
  for (const haptic::StrokeSample& sample : session) {
    if (sample.tool != haptic::Tool::kMark || !std::isfinite(sample.tip_mm.x) ||
        !std::isfinite(sample.tip_mm.y)) {
      end();
      continue;
    }
    // As locateEdgeLines() wants them: to 2^-20 samples.
    const auto rounded = [](double at) { return std::round(at * 0x1p20) * 0x1p-20; };
    stroke.points.emplace_back(rounded(sample.tip_mm.x / grid.spacingXMm()),
                               rounded(sample.tip_mm.y / grid.spacingYMm()));
  }
  end();
  return strokes;
}

}  // namespace fettle::app
