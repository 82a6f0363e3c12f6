#include "app/work/line_pieces.h"

#include <cstddef>
#include <functional>
#include <numeric>
#include <utility>

namespace fettle::app {

namespace {

using engine::EdgeLine;
using engine::EdgePoint;
using engine::LineKind;

constexpr double kBesideLine = 4.0;  // [samples] of a located point: no edge of its own if not located itself
constexpr double kAlongLine = 0.85;  // cosine between stretches along each other
constexpr std::ptrdiff_t kDoubled = 8;  // points of the shortest stretch; lines that cross share fewer
constexpr std::ptrdiff_t kBetween = 4;  // points of a stretch one after the other that may not be doubled
constexpr std::ptrdiff_t kWay = 3;      // points before and after that give a direction

// Located points with their directions, to be found by their place.
class EdgesSoFar {
 public:
  void add(const EdgeLine& line) {
    const auto n = static_cast<std::ptrdiff_t>(line.points.size());
    for (std::ptrdiff_t i = 0; i < n; ++i)
      if (const EdgePoint& p = line.points[static_cast<std::size_t>(i)]; p.located)
        cells_[cellAt(p.position.x, p.position.y)].push_back({p, directionAt(line, i)});
  }
  [[nodiscard]] bool has(const EdgeLine& line, std::ptrdiff_t at) const {
    const EdgePoint& p = line.points[static_cast<std::size_t>(at)];
    const glm::dvec2 way = directionAt(line, at);
    for (const double dy : {-kBesideLine, 0.0, kBesideLine})
      for (const double dx : {-kBesideLine, 0.0, kBesideLine}) {
        const auto cell = cells_.find(cellAt(p.position.x + dx, p.position.y + dy));
        if (cell != cells_.end() &&
            std::ranges::any_of(cell->second, [&](const Directed& other) { return isSame(p, way, other); }))
          return true;
      }
    return false;
  }

 private:
  struct Directed {
    EdgePoint point;
    glm::dvec2 way;
  };
  static bool isSame(const EdgePoint& p, glm::dvec2 way, const Directed& other) {
    const double along = glm::dot(way, other.way);
    if (std::abs(along) < kAlongLine) return false;
    const double apart = glm::distance(p.position, other.point.position);
    if (!p.located) return apart <= kBesideLine;
    const bool steps = p.kind == LineKind::kStep && other.point.kind == LineKind::kStep;
    return apart <= kSameEdge && !(steps && p.step * other.point.step * along < 0.0);
  }
  static glm::dvec2 directionAt(const EdgeLine& line, std::ptrdiff_t at) {
    const auto last = static_cast<std::ptrdiff_t>(line.points.size()) - 1;
    const auto position = [&](std::ptrdiff_t i) {
      return line.points[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(i, 0, last))].position;
    };
    const glm::dvec2 way = position(at + kWay) - position(at - kWay);
    const double length = glm::length(way);
    return length > 0.0 ? way / length : glm::dvec2(0.0);
  }
  static std::int64_t cellAt(double x, double y) {
    return static_cast<std::int64_t>(std::floor(x / kBesideLine)) * (std::int64_t{1} << 32) +
           static_cast<std::int64_t>(std::floor(y / kBesideLine));
  }
  std::unordered_map<std::int64_t, std::vector<Directed>> cells_;
};

// The points of the stretches that the edges so far describe as well; finds them exactly.
NearPoints doubledPoints(const EdgeLine& line, const EdgesSoFar& edges) {
  NearPoints doubled(0.0);
  const auto n = static_cast<std::ptrdiff_t>(line.points.size());
  for (std::ptrdiff_t from = 0; from < n;) {
    std::ptrdiff_t to = from;
    for (std::ptrdiff_t i = from; i < n && i <= to + kBetween; ++i)
      if (edges.has(line, i)) to = i + 1;
    if (to - from >= kDoubled)
      for (std::ptrdiff_t i = from; i < to; ++i)
        doubled.add(line.points[static_cast<std::size_t>(i)].position);
    from = std::max(to, from + 1);
  }
  return doubled;
}

}  // namespace

std::int64_t nextId(std::span<const engine::EdgeLine> lines) {
  std::int64_t next = 1;
  for (const engine::EdgeLine& line : lines) next = std::max(next, line.id + 1);
  return next;
}

bool mostlyAmong(const engine::EdgeLine& line, const NearPoints& others) {
  std::ptrdiff_t located = 0, among = 0;
  for (const engine::EdgePoint& p : line.points) {
    if (!p.located) continue;
    ++located;
    among += others.any(p.position) ? 1 : 0;
  }
  return 2 * among > located;
}

NearPoints pointsOf(std::span<const engine::EdgeLine> lines) {
  NearPoints points(kSameEdge);
  for (const engine::EdgeLine& line : lines)
    for (const engine::EdgePoint& p : line.points) points.add(p.position);
  return points;
}

std::vector<EdgeLine> linesOfOneEdgeEach(std::span<const EdgeLine> lines, std::span<const EdgeLine> present) {
  EdgesSoFar edges;
  for (const EdgeLine& line : present) edges.add(line);
  std::vector<std::size_t> order(lines.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater(), [&](std::size_t i) {
    return std::ranges::count_if(lines[i].points, &EdgePoint::located);
  });
  std::vector<std::vector<EdgeLine>> kept(lines.size());
  for (const std::size_t i : order) {
    const NearPoints doubled = doubledPoints(lines[i], edges);
    kept[i] = linesWithout(lines.subspan(i, 1), [&](const EdgePoint& p) { return doubled.any(p.position); });
    for (const EdgeLine& line : kept[i]) edges.add(line);
  }
  std::int64_t id = std::max(nextId(lines), nextId(present));
  std::vector<EdgeLine> all;
  for (std::size_t i = 0; i < lines.size(); ++i)
    for (std::size_t k = 0; k < kept[i].size(); ++k) {
      if (kept[i][k].id != lines[i].id) kept[i][k].id = id++;
      all.push_back(std::move(kept[i][k]));
    }
  return all;
}

std::vector<engine::EdgeLine> linesNotRedrawn(std::span<const engine::EdgeLine> all,
                                              const engine::EdgeLine& drawn) {
  if (all.empty() || !mostlyAmong(drawn, pointsOf(all))) return {all.begin(), all.end()};
  NearPoints again(kSameEdge);
  for (const engine::EdgePoint& p : drawn.points)
    if (p.located) again.add(p.position);
  return linesWithout(all, [&](const engine::EdgePoint& p) { return again.any(p.position); });
}

}  // namespace fettle::app
