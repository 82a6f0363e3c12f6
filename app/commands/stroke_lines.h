#pragma once

#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/edges/locate.h"
#include "engine/field/version.h"

namespace fettle::app {

/// The strokes of the tool `mark` in a strokes file (edgeStrokesOf). Errors (kInput): as readStrokes, no such stroke.
[[nodiscard]] engine::Result<std::vector<engine::EdgeStroke>> markedStrokes(const std::string& path,
                                                                            const engine::Grid& grid);

/// Edge lines along strokes, located by the samples of `field`, whose noise is measured. Errors: no noise, which
/// states how sure a line is (kInput); as locateEdgeLines. The
/// ends of the lines are extended to where they meet (engine::extendEnds).
[[nodiscard]] engine::Result<std::vector<engine::EdgeLine>> locateLines(
    const engine::Version& field, const std::vector<engine::EdgeStroke>& strokes,
    const engine::LocateOptions& options, engine::JobControl& job);

/// Adds marks to all samples within `thickness` [samples], 0 .. 64, of a point of the lines: 0 marks the nearest
/// sample of each. Holes are not marked. Errors: a thickness out of range (kInput), cancelled, memory.
[[nodiscard]] engine::Result<engine::Version> markLines(const engine::Version& field,
                                                        const std::vector<engine::EdgeLine>& lines,
                                                        double thickness, engine::JobControl& job);

}  // namespace fettle::app
