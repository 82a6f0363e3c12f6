#pragma once

#include <vector>

#include <glm/vec2.hpp>

#include "engine/edges/polyline.h"

namespace fettle::engine {

/// Another line, or a far part of the same one, that runs along a point: it crosses the normal, at 30 degrees
/// or more. [samples]
struct Neighbour {
  double offset = 0.0;  ///< across, from the point
  int line = 0;         ///< whose
  int point = 0;        ///< of that line
};

/// Finds the points of lines by place. Immutable; any thread.
class LineIndex {
 public:
  explicit LineIndex(const std::vector<Polyline>& lines);

  /// The neighbours of point `i` of line `own` within `depth` [samples], ordered by offset, each passage of a
  /// line once. Parts of the same line count from 3 `depth` along it.
  [[nodiscard]] std::vector<Neighbour> around(int own, int i, glm::dvec2 tangent, double depth) const;

 private:
  struct Entry {
    int across = 0, up = 0;  // cell
    int line = 0, point = 0;
  };
  static constexpr double kCell = 4.0;  // [samples]

  const std::vector<Polyline>& lines_;
  std::vector<Entry> entries_;  // ordered by cell, row by row
};

/// The neighbours of each point of a line.
using LineNeighbours = std::vector<std::vector<Neighbour>>;

/// The neighbours of all points of line `own`. Blocks, on all workers.
[[nodiscard]] LineNeighbours neighboursOf(const LineIndex& index, int own,
                                          const std::vector<glm::dvec2>& tangents, double depth);

/// On which side of point `i` the neighbour runs: the mean of its offsets at some 40 points before and after,
/// for two hands may cross where their edges do not. Negative: right; near 0: it crosses. [samples]
[[nodiscard]] double sideOf(const Polyline& line, const LineNeighbours& neighbours, int i,
                            const Neighbour& neighbour);

}  // namespace fettle::engine
