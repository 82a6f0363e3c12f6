#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/edges/neighbours.h"
#include "engine/edges/strip.h"

namespace fettle::engine {

/// What the lines next to a point mean for its own break.
struct Surroundings {
  std::vector<double> breaks{0.0};  ///< expected offsets that are searched jointly, ascending; own one is 0
  std::size_t own = 0;              ///< its place in them
  OffsetRange range;                ///< samples beyond belong to lines that are known
};

/// How far the search is. A line is strong when the first round found a step that stands out from the noise.
enum class Stage : std::uint8_t {
  kFirst,    ///< nothing is known: all neighbours are searched jointly
  kRestart,  ///< weak lines begin again, jointly; strong ones are known
  kRefine,   ///< all lines are known
};

/// The surroundings of each point of a line. `strong` by line.
[[nodiscard]] std::vector<Surroundings> surroundingsOf(const Polyline& line, const LineNeighbours& neighbours,
                                                       Stage stage, bool own_strong,
                                                       const std::vector<bool>& strong);

}  // namespace fettle::engine
