#include "engine/marks/chosen_lines.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "engine/marks/tile_bits.h"

namespace fettle::engine {

std::size_t shortestLine(const EdgeMap& map, const EdgeChoice& choice) noexcept {
  return static_cast<std::size_t>(choice.shortest > 0 ? choice.shortest
                                                      : std::max(1L, std::lround(4.0 * map.sigma)));
}

Result<std::vector<EdgePiece>> chosenLines(const Grid& grid, const EdgeMap& map, const EdgeChoice& choice,
                                           JobControl& job) {
  if (!(choice.sensitivity >= 0.0 && choice.sensitivity <= 1.0))
    return inputError(fmt::format("a sensitivity of {} cannot be used", choice.sensitivity), "sensitivity",
                      "give 0 to 1");
  const auto high = static_cast<float>(choice.strength());
  const float low = std::max(0.5F * high, EdgeMap::kLeastStrength);
  const std::size_t shortest = shortestLine(map, choice);
  job.begin("drawing edges", map.candidates.size());
  TileBits open(grid);
  for (const EdgeCandidate& e : map.candidates)
    if (e.strength >= low) open.set(e.column, e.row);
  std::vector<EdgePiece> lines;
  for (const EdgeCandidate& e : map.candidates) {
    job.advance();
    // A line is followed from the first of its strong samples.
    if (e.strength < high || !open.has(e.column, e.row)) continue;
    if (job.cancelled()) return cancelled();
    EdgePiece line(1, {e.column, e.row});
    open.clear(e.column, e.row);
    for (std::size_t i = 0; i < line.size(); ++i) {
      const EdgeSpot at = line[i];
      for (std::int32_t r = at.row - kLineGap; r <= at.row + kLineGap; ++r)
        for (std::int32_t c = at.column - kLineGap; c <= at.column + kLineGap; ++c)
          if (open.has(c, r)) {
            open.clear(c, r);
            line.push_back({c, r});
          }
    }
    if (line.size() >= shortest) lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace fettle::engine
