#pragma once

#include <vector>

#include "engine/field/edge_line.h"
#include "engine/scanner/scanner.h"

namespace fettle::engine {

/// The true edges of a simulated scan as edge lines, in samples: all points located, without deviation.
[[nodiscard]] std::vector<EdgeLine> trueLines(const SimulatedScan& scan);

}  // namespace fettle::engine
