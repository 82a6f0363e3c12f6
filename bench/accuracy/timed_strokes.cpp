#include "bench/accuracy/timed_strokes.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "haptic/operator/operator_strokes.h"

namespace fettle::bench {

namespace {

using Points = std::vector<glm::dvec2>;

constexpr double kSees = 8.0;  // [samples] from a place, within which an edge is the one that it shows
constexpr std::ptrdiff_t kLeastPoints = 8;  // of a stroke

double secondsFor(const Points& points, bool closed, double samples_per_s) {
  double length = closed ? glm::distance(points.front(), points.back()) : 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) length += glm::distance(points[i - 1], points[i]);
  return length / samples_per_s;
}

// Going from stroke to stroke.
class Person {
 public:
  Person(const engine::Grid& grid, double reach_s)
      : reach_s_(reach_s), samples_per_s_(haptic::OperatorSpec{}.speed_mm_s / grid.spacingXMm()) {}

  void draw(Points points, bool closed) {
    now_ += reach_s_;
    TimedStroke stroke{{static_cast<std::int64_t>(strokes_.size()), std::move(points), closed}, now_, now_};
    if (!stroke.stroke.points.empty()) now_ += secondsFor(stroke.stroke.points, closed, samples_per_s_);
    stroke.ends_s = now_;
    strokes_.push_back(std::move(stroke));
  }
  [[nodiscard]] std::vector<TimedStroke> strokes() && { return std::move(strokes_); }

 private:
  double reach_s_, samples_per_s_;
  double now_ = 0.0;
  std::vector<TimedStroke> strokes_;
};

Points samplesOf(const engine::Edge& edge, const engine::Grid& grid) {
  Points points;
  for (const glm::dvec2& p : edge.points_mm)
    points.emplace_back(p.x / grid.spacingXMm(), p.y / grid.spacingYMm());
  return points;
}

// Points of an edge, some of which are within sight of a place.
struct Sight {
  std::vector<bool> seen;    // of the edge's points
  std::size_t covered = 0;   // of the place's points
  std::ptrdiff_t first = 0;  // of the edge, nearest to the middle of the place
};

Sight sightOf(const Points& edge, const Points& place) {
  Sight sight{std::vector<bool>(edge.size(), false), 0, 0};
  const glm::dvec2 middle = place[place.size() / 2];
  double nearest = std::numeric_limits<double>::infinity();
  std::vector<bool> covered(place.size(), false);
  glm::dvec2 low = place.front(), high = low;
  for (const glm::dvec2& p : place) {
    low = glm::min(low, p - kSees);
    high = glm::max(high, p + kSees);
  }
  for (std::size_t i = 0; i < edge.size(); ++i) {
    if (glm::any(glm::lessThan(edge[i], low)) || glm::any(glm::greaterThan(edge[i], high))) continue;
    if (const double d = glm::distance(edge[i], middle); d < nearest) {
      nearest = d;
      sight.first = static_cast<std::ptrdiff_t>(i);
    }
    for (std::size_t k = 0; k < place.size(); ++k)
      if (glm::distance(edge[i], place[k]) <= kSees) sight.seen[i] = covered[k] = true;
  }
  sight.covered = static_cast<std::size_t>(std::ranges::count(covered, true));
  return sight;
}

}  // namespace

std::vector<TimedStroke> strokesAtPlaces(const engine::SimulatedScan& scan, const DrawnEdges& drawn,
                                         std::span<const engine::WorthPlace> places, double reach_s) {
  std::vector<Points> edges;
  std::vector<std::vector<bool>> done;
  for (const engine::Edge& edge : scan.edge_lines) {
    edges.push_back(samplesOf(edge, scan.scan.grid()));
    done.emplace_back(edge.points_mm.size(), false);
  }
  Person person(scan.scan.grid(), reach_s);
  for (const engine::WorthPlace& place : places) {
    Sight best;
    std::size_t which = edges.size();
    for (std::size_t e = 0; e < edges.size(); ++e) {
      Sight sight = sightOf(edges[e], place.path);
      for (std::size_t i = 0; i < sight.seen.size(); ++i)
        if (done[e][i]) sight.seen[i] = false;
      if (sight.covered <= best.covered || !sight.seen[static_cast<std::size_t>(sight.first)]) continue;
      best = std::move(sight);
      which = e;
    }
    if (which == edges.size() || 2 * best.covered < place.path.size()) {
      person.draw({}, false);
      continue;
    }
    // From the middle in both directions as far as it is seen.
    const auto n = static_cast<std::ptrdiff_t>(best.seen.size());
    const bool closed = scan.edge_lines[which].closed;
    const auto at = [&](std::ptrdiff_t i) { return static_cast<std::size_t>((i % n + n) % n); };
    const auto seen = [&](std::ptrdiff_t i) { return (closed || (i >= 0 && i < n)) && best.seen[at(i)]; };
    std::ptrdiff_t from = best.first, to = best.first;
    while (to - from + 1 < n && seen(to + 1)) ++to;
    while (to - from + 1 < n && seen(from - 1)) --from;
    Points stroke;
    if (to - from + 1 >= kLeastPoints)
      for (std::ptrdiff_t i = from; i <= to; ++i) {
        stroke.push_back(drawn.strokes[which].points[at(i)]);
        done[which][at(i)] = true;
      }
    person.draw(std::move(stroke), closed && to - from + 1 == n);
  }
  return std::move(person).strokes();
}

std::vector<TimedStroke> strokesByLength(const engine::SimulatedScan& scan, const DrawnEdges& drawn,
                                         double reach_s) {
  std::vector<double> lengths;
  for (const engine::EdgeStroke& stroke : drawn.strokes)
    lengths.push_back(secondsFor(stroke.points, stroke.closed, 1.0));
  std::vector<std::size_t> order(lengths.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return lengths[a] > lengths[b]; });
  Person person(scan.scan.grid(), reach_s);
  for (const std::size_t i : order) person.draw(drawn.strokes[i].points, drawn.strokes[i].closed);
  return std::move(person).strokes();
}

std::vector<engine::EdgeStroke> drawnUntil(std::span<const TimedStroke> strokes, double seconds) {
  std::vector<engine::EdgeStroke> drawn;
  for (const TimedStroke& timed : strokes) {
    if (timed.stroke.points.empty() || timed.begins_s >= seconds) continue;
    engine::EdgeStroke stroke = timed.stroke;
    if (timed.ends_s > seconds) {
      const double share = (seconds - timed.begins_s) / (timed.ends_s - timed.begins_s);
      const auto points = static_cast<std::size_t>(share * static_cast<double>(stroke.points.size()));
      if (points < static_cast<std::size_t>(kLeastPoints)) continue;
      stroke.points.resize(points);
      stroke.closed = false;
    }
    drawn.push_back(std::move(stroke));
  }
  return drawn;
}

}  // namespace fettle::bench
