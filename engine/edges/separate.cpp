#include "engine/edges/separate.h"

#include <cmath>
#include <cstddef>

#include "engine/edges/neighbours.h"

namespace fettle::engine {

namespace {

constexpr int kSweeps = 8;
constexpr int kTangentHalf = 3;
constexpr double kSeen = 10.0;           // neighbours that give the order [samples]
constexpr double kGap = 0.25;            // between lines afterwards [samples]
constexpr double kAlongEachOther = 0.3;  // mean distance of lines that have an order [samples]

// Across the line, by how much point `i` has to move; its neighbours move as far the other way.
double push(const Polyline& line, const LineNeighbours& neighbours, int i) {
  double most = 0.0;
  for (const Neighbour& neighbour : neighbours[static_cast<std::size_t>(i)]) {
    const double side = sideOf(line, neighbours, i, neighbour);
    if (std::abs(side) < kAlongEachOther) continue;
    const double gap = side > 0.0 ? neighbour.offset : -neighbour.offset;
    if (gap >= kGap) continue;
    const double move = std::copysign(0.5 * (kGap - gap), -side);
    if (std::abs(move) > std::abs(most)) most = move;
  }
  return most;
}

}  // namespace

void separate(std::vector<Polyline>& lines) {
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const LineIndex index(lines);
    std::vector<Polyline> next = lines;
    bool moved = false;
    for (std::size_t k = 0; k < lines.size(); ++k) {
      const std::vector<glm::dvec2> tangents = tangentsOf(lines[k], kTangentHalf);
      const LineNeighbours neighbours = neighboursOf(index, static_cast<int>(k), tangents, kSeen);
      for (std::size_t i = 0; i < tangents.size(); ++i) {
        const double move = push(lines[k], neighbours, static_cast<int>(i));
        if (move == 0.0) continue;
        next[k].points[i] += glm::dvec2(-tangents[i].y, tangents[i].x) * move;
        moved = true;
      }
    }
    if (!moved) return;
    lines = std::move(next);
  }
}

}  // namespace fettle::engine
