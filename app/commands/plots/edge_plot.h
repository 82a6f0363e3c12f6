#pragma once

#include <string>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "engine/base/error.h"
#include "engine/edges/edge_profile.h"
#include "engine/field/grid.h"

namespace fettle::app {

/// A line and what was measured along it.
struct MeasuredLine {
  engine::EdgeLine line;
  std::vector<engine::EdgeSection> sections;  ///< one per point
  engine::EdgeMeans means;
  double length_mm = 0.0;  ///< of a closed line all around

  MeasuredLine(engine::EdgeLine from, std::vector<engine::EdgeSection> at, const engine::EdgeMeans& mean,
               const engine::Grid& grid)
      : line(std::move(from)), sections(std::move(at)), means(mean) {
    if (sections.empty()) return;
    length_mm = sections.back().along_mm;
    const glm::dvec2 spacing(grid.spacingXMm(), grid.spacingYMm());
    if (line.closed)
      length_mm += glm::length((sections.front().position - sections.back().position) * spacing);
  }
};

/// An SVG of step height and turn over the length of the longest lines, each with a band of its standard deviation.
/// Heights in `unit`. Errors (kFailed): as drawnByGnuplot.
[[nodiscard]] engine::Result<std::string> edgePlot(const std::vector<MeasuredLine>& lines,
                                                   const engine::LengthUnit& unit);

}  // namespace fettle::app
