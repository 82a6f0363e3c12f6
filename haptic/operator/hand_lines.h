#pragma once

#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/field/grid.h"
#include "engine/scanner/scanner.h"
#include "haptic/operator/operator_strokes.h"

namespace fettle::haptic {

/// A person's stroke along an edge, seen from above.
struct HandLine {
  std::vector<glm::dvec2>
      points;           ///< [samples] (column, row), about one sample apart, also outside the field
  bool closed = false;  ///< as the edge; start and end are as far from it as the rest
};

/// The lines that the person of `spec` draws along the edges, one for each, in their order: drift and tremor
/// about the edge at the person's speed. Of `spec` seed, speed, tremor and drift count. Deterministic by seed.
[[nodiscard]] std::vector<HandLine> handLines(std::span<const engine::Edge> edges, const engine::Grid& grid,
                                              const OperatorSpec& spec);

}  // namespace fettle::haptic
