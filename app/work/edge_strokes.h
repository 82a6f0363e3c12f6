#pragma once

#include <span>
#include <vector>

#include "engine/edges/locate.h"
#include "engine/field/grid.h"
#include "haptic/base/strokes.h"

namespace fettle::app {

/// The strokes of the mark tool in a recorded session, as strokes along edges: a row for each tick, from where the
/// tool is first set down until another tool is used or the tip is lost (not finite). Closed as isClosedStroke() says.
/// Numbered from 0 in their order. Thread: any.
[[nodiscard]] std::vector<engine::EdgeStroke> edgeStrokesOf(std::span<const haptic::StrokeSample> session,
                                                            const engine::Grid& grid);

/// Whether a stroke ends within 3 samples of where it began, and is at least 30 long. Thread: any.
[[nodiscard]] bool isClosedStroke(std::span<const glm::dvec2> points);

}  // namespace fettle::app
