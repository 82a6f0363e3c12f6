#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include <glm/vec2.hpp>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/edges/locate.h"
#include "engine/field/version.h"
#include "engine/marks/edge_suggestion.h"

namespace fettle::app {

// Changes of a version's edge lines: the same heights. Positions are sample coordinates. Thread: any; long jobs.

/// A stroke along an edge, and the marks it has set.
struct LineStroke {
  std::span<const glm::dvec2> points;     ///< as one of MarkStroke::pieces
  const engine::Version &before, &after;  ///< the field before the stroke and at its end
  double mark_radius = 0.0;               ///< of the marking brush [samples]
};

/// Locates the edge along a stroke and adds its line; the present lines next to it stay where they are, and their edges
/// are not taken again. Where most of it is an edge that has a line, it replaces that part of the old line. Where the
/// line was located the marks that the stroke has set are removed: the line knows the edge better. What cannot be
/// located remains a plain mark; `base` itself where nothing can.
/// The noise is that of the samples around the stroke. Errors: as engine::locateEdgeLines().
[[nodiscard]] engine::Result<engine::Version> drawLine(const engine::Version& base, const LineStroke& stroke,
                                                       const engine::LocateOptions& options,
                                                       engine::JobControl& job);

/// Locates all edges that a suggestion takes (engine::traceEdges) and adds their lines, but for those that are mostly
/// edges of lines that are there; an edge that was traced twice has one line (linesOfOneEdgeEach). What cannot be located is marked, `choice.thickness` wide. Errors: those of traceEdges,
/// estimateNoise and locateEdgeLines.
[[nodiscard]] engine::Result<engine::Version> drawSuggestion(const engine::Version& base,
                                                             const engine::EdgeMap& map,
                                                             const engine::EdgeChoice& choice,
                                                             engine::JobControl& job);

/// Removes the parts of lines within `radius` of a path. What remains of a line in several pieces are lines of their
/// own; pieces of fewer than 5 points go. `base` itself where no line is near.
[[nodiscard]] engine::Version eraseLines(const engine::Version& base, std::span<const glm::dvec2> path,
                                         double radius);

/// Without the line of an id; without all lines when there is no id.
[[nodiscard]] engine::Version removeLines(const engine::Version& base, std::optional<std::int64_t> id);

/// Moves the part of a line around `from` [samples], its nearest point, by to - from, less and less along the line, as a
/// thread that is pulled, and locates that part of it again from there. Errors: kInput where there is no such line
/// or no edge is found; as engine::locateEdgeLines().
[[nodiscard]] engine::Result<engine::Version> dragLine(const engine::Version& base, std::int64_t id,
                                                       glm::dvec2 from, glm::dvec2 to,
                                                       const engine::LocateOptions& options,
                                                       engine::JobControl& job);

/// Joins a line with the one whose end is nearest to one of its ends, its own other end included, and locates the whole
/// again under its id. Errors: kInput where there is no such line, it is closed, or no end is within 60 samples; as
/// engine::locateEdgeLines().
[[nodiscard]] engine::Result<engine::Version> joinLine(const engine::Version& base, std::int64_t id,
                                                       const engine::LocateOptions& options,
                                                       engine::JobControl& job);

}  // namespace fettle::app
