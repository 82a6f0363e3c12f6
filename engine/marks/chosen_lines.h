#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/grid.h"
#include "engine/marks/edge_suggestion.h"

namespace fettle::engine {

/// A sample by its column and row.
struct EdgeSpot {
  std::int32_t column = 0, row = 0;
  friend bool operator==(const EdgeSpot&, const EdgeSpot&) = default;
};
using EdgePiece = std::vector<EdgeSpot>;

/// Samples up to this many columns and rows apart belong to one line: thinning leaves gaps where directions are rounded.
inline constexpr std::int32_t kLineGap = 2;

/// Samples that the shortest line of a choice has.
[[nodiscard]] std::size_t shortestLine(const EdgeMap& map, const EdgeChoice& choice) noexcept;

/// The connected pieces that a choice takes from a map (hysteresis, see suggestMarks()), in the order of their first
/// strong candidates. Errors: a choice out of range (kInput), cancelled. Throws std::bad_alloc.
[[nodiscard]] Result<std::vector<EdgePiece>> chosenLines(const Grid& grid, const EdgeMap& map,
                                                         const EdgeChoice& choice, JobControl& job);

}  // namespace fettle::engine
