#pragma once

#include <glm/vec2.hpp>

#include "engine/scanner/scanner.h"

namespace fettle::engine {

/// Distance of a point from the line of an edge in the plane, in millimetres of field coordinates. Time
/// proportional to the edge's points; infinity without any.
[[nodiscard]] double distanceFrom(const Edge& edge, glm::dvec2 point_mm);

}  // namespace fettle::engine
