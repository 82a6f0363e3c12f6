#pragma once

#include <cstdint>
#include <vector>

#include "engine/field/version.h"

namespace fettle::engine {

/// Where a sample lies by its distance from the next edge, as compareToTruth has it (TruthOptions).
enum class SampleZone : std::uint8_t {
  kFlat,     ///< farther from every edge than TruthOptions::flat
  kBetween,  ///< neither
  kEdge      ///< up to TruthOptions::near_edge
};

/// Of each sample of `edges`, row-major; its marks are the edges. Any thread. Throws std::bad_alloc.
[[nodiscard]] std::vector<SampleZone> zonesBesideMarks(const Version& edges);

}  // namespace fettle::engine
