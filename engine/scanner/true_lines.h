#pragma once

#include <vector>

#include <glm/vec2.hpp>

#include "engine/field/edge_line.h"
#include "engine/scanner/scanner.h"

namespace fettle::engine {

/// The true edges of a simulated scan as edge lines, in samples: all points located, without deviation.
[[nodiscard]] std::vector<EdgeLine> trueLines(const SimulatedScan& scan);

/// Distance of a point from the line of an edge in the plane, in millimetres of field coordinates. Time
/// proportional to the edge's points; infinity without any.
[[nodiscard]] double distanceFrom(const Edge& edge, glm::dvec2 point_mm);

}  // namespace fettle::engine
