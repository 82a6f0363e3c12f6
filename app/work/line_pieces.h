#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include <glm/geometric.hpp>

#include "engine/field/edge_line.h"

namespace fettle::app {

// Lines and parts of them, as lists of points. Positions are sample coordinates. Thread: any.

/// Lines located this near to each other are of one edge [samples].
inline constexpr double kSameEdge = 1.0;
/// Points of the shortest line.
inline constexpr std::size_t kLeastPoints = 5;

/// One more than any id.
[[nodiscard]] std::int64_t nextId(std::span<const engine::EdgeLine> lines);

/// Finds whether any of many points is within a distance of a place.
class NearPoints {
 public:
  explicit NearPoints(double distance) : distance_(distance), cell_(std::max(distance, 1.0)) {}
  void add(glm::dvec2 p) { cells_[cellOf(std::floor(p.x / cell_), std::floor(p.y / cell_))].push_back(p); }
  [[nodiscard]] bool any(glm::dvec2 at) const {
    for (const double dy : {-1.0, 0.0, 1.0})
      for (const double dx : {-1.0, 0.0, 1.0}) {
        const auto cell = cells_.find(cellOf(std::floor(at.x / cell_) + dx, std::floor(at.y / cell_) + dy));
        if (cell != cells_.end() && std::ranges::any_of(cell->second, [&](const glm::dvec2& p) {
              return glm::distance(p, at) <= distance_;
            }))
          return true;
      }
    return false;
  }

 private:
  // Positions are within 2^20 samples.
  static std::int64_t cellOf(double x, double y) {
    return static_cast<std::int64_t>(x) * (std::int64_t{1} << 32) + static_cast<std::int64_t>(y);
  }
  double distance_, cell_;
  std::unordered_map<std::int64_t, std::vector<glm::dvec2>> cells_;
};

/// The lines without the points that `covered` holds for. The first piece of a line keeps its id, the others get new ones;
/// pieces of fewer than kLeastPoints go.
std::vector<engine::EdgeLine> linesWithout(std::span<const engine::EdgeLine> all, auto&& covered) {
  std::int64_t id = nextId(all);
  std::vector<engine::EdgeLine> lines;
  for (const engine::EdgeLine& line : all) {
    const auto cut = std::ranges::find_if(line.points, covered);
    if (cut == line.points.end()) {
      lines.push_back(line);
      continue;
    }
    // A closed line is opened where it is cut first.
    std::vector<engine::EdgePoint> points = line.points;
    if (line.closed) std::rotate(points.begin(), points.begin() + (cut - line.points.begin()), points.end());
    bool first = true;
    for (auto from = points.begin(); from != points.end();) {
      from = std::find_if_not(from, points.end(), covered);
      const auto to = std::find_if(from, points.end(), covered);
      if (static_cast<std::size_t>(to - from) >= kLeastPoints) {
        lines.push_back({first ? line.id : id++, false, {from, to}});
        first = false;
      }
      from = to;
    }
  }
  return lines;
}

/// Whether most of what is located of a line lies on other ones.
[[nodiscard]] bool mostlyAmong(const engine::EdgeLine& line, const NearPoints& others);

/// All their points, to be found within kSameEdge.
[[nodiscard]] NearPoints pointsOf(std::span<const engine::EdgeLine> lines);

/// The lines without what a line with more located points, or one of `present`, describes as well: stretches of 8 points
/// and more along it, located within kSameEdge with a step in the same sense, or not located and within 4 samples of
/// what it has located. A wall that a search traced twice has one line then. Their order stays; as linesWithout().
[[nodiscard]] std::vector<engine::EdgeLine> linesOfOneEdgeEach(std::span<const engine::EdgeLine> lines,
                                                               std::span<const engine::EdgeLine> present);

/// The lines without what a stroke draws again, where that is most of what was located along it; all of them where it is
/// an edge of its own.
[[nodiscard]] std::vector<engine::EdgeLine> linesNotRedrawn(std::span<const engine::EdgeLine> all,
                                                            const engine::EdgeLine& drawn);

}  // namespace fettle::app
