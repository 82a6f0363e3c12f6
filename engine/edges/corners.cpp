#include "engine/edges/corners.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>

#include <glm/geometric.hpp>

namespace fettle::engine {

namespace {

constexpr std::size_t kTangentPoints = 8;  // whose mean direction is that of an end
constexpr double kAlong = 0.35;            // sine of the least angle between lines that meet
constexpr double kMeets = 0.25;            // an end this near to a line meets it [samples]
constexpr double kCornerStep = 0x1p-20;    // of a position [samples]

double cross(glm::dvec2 a, glm::dvec2 b) noexcept {
  return a.x * b.y - a.y * b.x;
}

struct End {
  std::size_t line = 0;
  bool at_back = false;
  glm::dvec2 from{0.0}, along{0.0};  // where it is, and its unit direction, outwards
};

// Things by place: those within a cell of another place are found.
template <class T>
class Cells {
 public:
  void add(glm::dvec2 at, const T& thing) { cells_[cellOf(at)].push_back(thing); }
  template <class Visit>
  void forEachNear(glm::dvec2 at, Visit&& visit) const {
    for (const double dy : {-kCell, 0.0, kCell})
      for (const double dx : {-kCell, 0.0, kCell}) {
        const auto cell = cells_.find(cellOf(at + glm::dvec2(dx, dy)));
        if (cell != cells_.end())
          for (const T& thing : cell->second) visit(thing);
      }
  }

 private:
  static constexpr double kCell = 2.0 * kMostExtension;  // two extensions, or one and a segment
  // Positions are within 2^20 samples.
  static std::int64_t cellOf(glm::dvec2 p) {
    return static_cast<std::int64_t>(std::floor(p.x / kCell)) * (std::int64_t{1} << 32) +
           static_cast<std::int64_t>(std::floor(p.y / kCell));
  }
  std::unordered_map<std::int64_t, std::vector<T>> cells_;
};

struct Segment {
  std::size_t line = 0;
  glm::dvec2 a{0.0}, b{0.0};
};

Cells<Segment> segmentsOf(std::span<const EdgeLine> lines) {
  Cells<Segment> cells;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const std::vector<EdgePoint>& points = lines[k].points;
    for (std::size_t i = 0; i + (lines[k].closed ? 0 : 1) < points.size(); ++i) {
      const EdgePoint &a = points[i], &b = points[(i + 1) % points.size()];
      if (a.located && b.located) cells.add(a.position, {k, a.position, b.position});
    }
  }
  return cells;
}

std::optional<End> endOf(const EdgeLine& line, std::size_t number, bool at_back) {
  if (line.closed || line.points.size() < 2) return std::nullopt;
  const std::size_t n = line.points.size();
  const auto point = [&](std::size_t i) -> const EdgePoint& { return line.points[at_back ? n - 1 - i : i]; };
  std::size_t last = 0;
  while (last < std::min(n, kTangentPoints) && point(last).located) ++last;
  if (last < 2) return std::nullopt;
  const glm::dvec2 along = point(0).position - point(last - 1).position;
  const double length = glm::length(along);
  if (!(length > 0.5)) return std::nullopt;
  return End{number, at_back, point(0).position, along / length};
}

double distanceToSegment(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) noexcept {
  const glm::dvec2 ab = b - a;
  const double square = glm::dot(ab, ab);
  const double t = square > 0.0 ? std::clamp(glm::dot(p - a, ab) / square, 0.0, 1.0) : 0.0;
  return glm::distance(p, a + t * ab);
}

// How far an end is from the border straight on.
double toBorder(const End& end, glm::dvec2 high) noexcept {
  double t = HUGE_VAL;
  for (int axis = 0; axis < 2; ++axis) {
    if (end.along[axis] > 0.0) t = std::min(t, (high[axis] - end.from[axis]) / end.along[axis]);
    if (end.along[axis] < 0.0) t = std::min(t, -end.from[axis] / end.along[axis]);
  }
  return t;
}

// What an end meets straight on first.
struct Meeting {
  double length = HUGE_VAL;  // of the extension
  std::size_t line = 0;      // number; kBorder
  static constexpr std::size_t kBorder = 0;
};

// Nothing when the end meets something already or nothing is near.
std::optional<Meeting> meetingOf(const End& end, const Cells<Segment>& segments, const Cells<End>& ends,
                                 glm::dvec2 high) {
  Meeting nearest{toBorder(end, high), Meeting::kBorder};
  bool meets = false;
  const auto meet = [&nearest](double length, std::size_t line) {
    if (length > 0.0 && length < nearest.length) nearest = {length, line};
  };
  segments.forEachNear(end.from, [&](const Segment& other) {
    if (other.line == end.line) return;
    meets = meets || distanceToSegment(end.from, other.a, other.b) <= kMeets;
    const glm::dvec2 ab = other.b - other.a;
    const double sine = cross(end.along, ab);
    if (sine == 0.0 || std::abs(sine) < kAlong * glm::length(ab)) return;
    const double u = cross(other.a - end.from, end.along) / sine;
    if (u >= 0.0 && u <= 1.0) meet(cross(other.a - end.from, ab) / sine, other.line);
  });
  ends.forEachNear(end.from, [&](const End& other) {
    if (other.line == end.line && other.at_back == end.at_back) return;
    const glm::dvec2 apart = other.from - end.from;
    meets = meets || glm::length(apart) <= kMeets;
    const double sine = cross(end.along, other.along);
    if (std::abs(sine) < kAlong) return;
    const double u = cross(apart, end.along) / sine;
    if (u > 0.0 && u <= kMostExtension) meet(cross(apart, other.along) / sine, other.line);
  });
  if (meets || !(nearest.length > 0.0 && nearest.length <= kMostExtension)) return std::nullopt;
  return nearest;
}

}  // namespace

void extendEnds(std::vector<EdgeLine>& lines, std::size_t first, std::int32_t columns, std::int32_t rows) {
  const Cells<Segment> segments = segmentsOf(lines);
  Cells<End> ends;
  std::vector<End> open;
  for (std::size_t k = 0; k < lines.size(); ++k)
    for (const bool at_back : {false, true})
      if (const auto end = endOf(lines[k], k, at_back)) {
        ends.add(end->from, *end);
        open.push_back(*end);
      }
  const glm::dvec2 high(columns - 1, rows - 1);
  std::vector<std::pair<End, double>> extensions;
  for (const End& end : open)
    if (const auto meeting = meetingOf(end, segments, ends, high);
        meeting && (end.line >= first || meeting->line >= std::max<std::size_t>(first, 1)))
      extensions.emplace_back(end, meeting->length);
  for (const auto& [end, length] : extensions) {
    std::vector<EdgePoint>& points = lines[end.line].points;
    const EdgePoint last = end.at_back ? points.back() : points.front();
    const int steps = std::max(1, static_cast<int>(std::ceil(length)));
    for (int k = 1; k <= steps; ++k) {
      const double on = length * k / steps;
      EdgePoint point = last;
      point.position = glm::round((end.from + on * end.along) / kCornerStep) * kCornerStep;
      point.deviation = std::hypot(last.deviation, kEndTangent * on);
      points.insert(end.at_back ? points.end() : points.begin(), point);
    }
  }
}

EdgeLine withoutExtensions(const EdgeLine& line) {
  EdgeLine bare = line;
  if (line.closed) return bare;
  std::vector<EdgePoint>& points = bare.points;
  const auto copied = [](const EdgePoint& end, const EdgePoint& before) {
    return end.located && before.located && end.step == before.step &&
           end.step_deviation == before.step_deviation && end.slope_change == before.slope_change &&
           end.slope_deviation == before.slope_deviation;
  };
  while (points.size() > 2 && copied(points.back(), points[points.size() - 2])) points.pop_back();
  const auto first = std::ranges::adjacent_find(points, std::not_fn(copied));
  if (first != points.end()) points.erase(points.begin(), first);
  return bare;
}

}  // namespace fettle::engine
