#pragma once

#include <vector>

#include <glm/vec2.hpp>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/grid.h"
#include "engine/marks/edge_suggestion.h"

namespace fettle::engine {

/// Samples of an edge in the order in which a hand would draw along it.
struct EdgeTrace {
  std::vector<glm::dvec2> points;  ///< [samples], at most 8 apart
  bool closed = false;             ///< the last point joins the first
};

/// The lines that suggestMarks() takes, as traces: each piece of connected samples is divided into paths, the longest
/// first, and ends of paths that continue each other are joined. Paths of fewer samples than the choice's shortest
/// line are left out. The result depends on nothing but the map, the choice and the size of the field. Progress counts
/// candidates. Errors: as suggestMarks(). Thread: any; O(n log n) for n candidates times the depth of branching.
[[nodiscard]] Result<std::vector<EdgeTrace>> traceEdges(const Grid& grid, const EdgeMap& map,
                                                        const EdgeChoice& choice, JobControl& job);

}  // namespace fettle::engine
