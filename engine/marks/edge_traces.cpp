#include "engine/marks/edge_traces.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <new>
#include <queue>
#include <tuple>
#include <utility>

#include <glm/geometric.hpp>

#include "engine/marks/chosen_lines.h"

namespace fettle::engine {

namespace {

constexpr double kMeets = 8.0;         // [samples] between ends that may be joined: across another path
constexpr double kContinues = 0.7;     // cosine of the largest turn between paths that are joined
constexpr std::size_t kDirection = 8;  // samples that give the direction of an end
constexpr double kLeastClosed = 30.0;  // [samples] length of a closed line

// A piece of samples as a graph: neighbours are up to kLineGap apart.
class PieceGraph {
 public:
  explicit PieceGraph(EdgePiece spots)
      : spots_(std::move(spots)),
        open_(spots_.size(), true),
        distance_(spots_.size(), kFar),
        before_(spots_.size(), 0) {
    std::ranges::sort(spots_, less);
  }

  // Takes the longest way through the first connected part that is left, and removes what lies along it. Empty when
  // nothing is left.
  EdgePiece takePath() {
    while (first_ < spots_.size() && !open_[first_]) ++first_;
    if (first_ == spots_.size()) return {};
    // The sample farthest from any other is an end of the longest way, if there are no loops.
    const std::size_t from = farthest(first_).back();
    const std::vector<std::size_t> way = farthest(from);
    EdgePiece path;
    for (const std::size_t i : way) path.push_back(spots_[i]);
    for (const EdgeSpot& spot : path) forEachNear(spot, [&](std::size_t i) { open_[i] = false; });
    return path;
  }

 private:
  static constexpr int kFar = std::numeric_limits<int>::max();
  static bool less(const EdgeSpot& a, const EdgeSpot& b) {
    return std::pair(a.row, a.column) < std::pair(b.row, b.column);
  }
  void forEachNear(const EdgeSpot& at, auto&& visit) const {
    for (std::int32_t r = at.row - kLineGap; r <= at.row + kLineGap; ++r) {
      auto i = static_cast<std::size_t>(
          std::ranges::lower_bound(spots_, EdgeSpot{at.column - kLineGap, r}, less) - spots_.begin());
      for (; i < spots_.size() && spots_[i].row == r && spots_[i].column <= at.column + kLineGap; ++i)
        if (open_[i]) visit(i);
    }
  }
  // The shortest way from a sample to the one to which it is longest (Dijkstra 1959). A way of squares of distances
  // takes all samples in between.
  std::vector<std::size_t> farthest(std::size_t from) {
    for (const std::size_t i : seen_) distance_[i] = kFar;
    seen_.assign(1, from);
    using Entry = std::pair<int, std::size_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    distance_[from] = 0;
    queue.emplace(0, from);
    std::size_t last = from;
    while (!queue.empty()) {
      const int length = queue.top().first;
      const std::size_t at = queue.top().second;
      queue.pop();
      if (length > distance_[at]) continue;
      last = at;
      forEachNear(spots_[at], [&](std::size_t i) {
        const std::int32_t dc = spots_[i].column - spots_[at].column, dr = spots_[i].row - spots_[at].row;
        const int next = length + dc * dc + dr * dr;
        if (next >= distance_[i]) return;
        if (distance_[i] == kFar) seen_.push_back(i);
        distance_[i] = next;
        before_[i] = at;
        queue.emplace(next, i);
      });
    }
    std::vector<std::size_t> way{last};
    while (way.back() != from) way.push_back(before_[way.back()]);
    std::ranges::reverse(way);
    return way;
  }

  std::vector<EdgeSpot> spots_;  // ordered
  std::vector<bool> open_;
  // Of the search: only the entries of the samples it has seen are in use, so that it costs what it sees.
  std::vector<int> distance_;
  std::vector<std::size_t> before_, seen_;
  std::size_t first_ = 0;  // none before is open
};

using Points = std::vector<glm::dvec2>;

// Where an end of a path points to.
glm::dvec2 directionAt(const Points& path, bool back) {
  const std::size_t n = std::min(kDirection, path.size() - 1);
  const glm::dvec2 end = back ? path.back() : path.front();
  const glm::dvec2 inner = back ? path[path.size() - 1 - n] : path[n];
  return glm::normalize(end - inner);
}

// An end of a path: its number is twice the path's, plus one at the back.
struct End {
  std::size_t number = 0;
  glm::dvec2 at{0.0}, direction{0.0};
};

struct Joint {
  double length = 0.0;
  std::size_t first = 0, second = 0;  // ends
};

// Pairs of ends that are near and continue each other, the nearest first.
std::vector<Joint> possibleJoints(const std::vector<Points>& paths) {
  std::vector<End> ends;
  for (std::size_t i = 0; i < paths.size(); ++i)
    for (const bool back : {false, true})
      ends.push_back(
          {2 * i + (back ? 1 : 0), back ? paths[i].back() : paths[i].front(), directionAt(paths[i], back)});
  std::ranges::sort(ends, {}, [](const End& end) { return std::tuple(end.at.x, end.number); });
  std::vector<Joint> joints;
  for (std::size_t a = 0; a < ends.size(); ++a)
    for (std::size_t b = a + 1; b < ends.size() && ends[b].at.x - ends[a].at.x <= kMeets; ++b) {
      const double length = glm::distance(ends[a].at, ends[b].at);
      if (length <= kMeets && -glm::dot(ends[a].direction, ends[b].direction) >= kContinues)
        joints.push_back(
            {length, std::min(ends[a].number, ends[b].number), std::max(ends[a].number, ends[b].number)});
    }
  std::ranges::sort(joints, {}, [](const Joint& j) { return std::tuple(j.length, j.first, j.second); });
  return joints;
}

// Each end is joined once at most, and a path never with itself.
std::vector<Points> joined(std::vector<Points> paths) {
  constexpr auto kFree = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> other(2 * paths.size(), kFree);  // the end that an end is joined with
  std::vector<std::size_t> group(paths.size());
  for (std::size_t i = 0; i < paths.size(); ++i) group[i] = i;
  const auto groupOf = [&](std::size_t path) {
    while (group[path] != path) path = group[path] = group[group[path]];
    return path;
  };
  for (const Joint& joint : possibleJoints(paths)) {
    const std::size_t a = groupOf(joint.first / 2), b = groupOf(joint.second / 2);
    if (a == b || other[joint.first] != kFree || other[joint.second] != kFree) continue;
    group[std::max(a, b)] = std::min(a, b);
    other[joint.first] = joint.second;
    other[joint.second] = joint.first;
  }
  std::vector<Points> out;
  std::vector<bool> done(paths.size(), false);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    if (done[i] || (other[2 * i] != kFree && other[2 * i + 1] != kFree))
      continue;  // in the middle of a chain
    Points chain;
    // From a free end through each path to its other end.
    for (std::size_t end = other[2 * i] == kFree ? 2 * i : 2 * i + 1; end != kFree; end = other[end ^ 1U]) {
      Points path = std::move(paths[end / 2]);
      done[end / 2] = true;
      if (end % 2 != 0) std::ranges::reverse(path);
      chain.insert(chain.end(), path.begin(), path.end());
    }
    out.push_back(std::move(chain));
  }
  return out;
}

bool isClosed(const Points& path) {
  double length = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) length += glm::distance(path[i - 1], path[i]);
  return length >= kLeastClosed && glm::distance(path.front(), path.back()) <= kMeets;
}

}  // namespace

Result<std::vector<EdgeTrace>> traceEdges(const Grid& grid, const EdgeMap& map, const EdgeChoice& choice,
                                          JobControl& job) try {
  auto lines = chosenLines(grid, map, choice, job);
  if (!lines) return tl::unexpected(lines.error());
  const std::size_t shortest = std::max<std::size_t>(shortestLine(map, choice), 2);
  std::vector<EdgeTrace> traces;
  for (EdgePiece& line : *lines) {
    PieceGraph graph(std::move(line));
    std::vector<Points> paths;
    for (EdgePiece path = graph.takePath(); !path.empty(); path = graph.takePath()) {
      if (job.cancelled()) return cancelled();
      if (path.size() < shortest) continue;
      Points points;
      for (const EdgeSpot& spot : path) points.emplace_back(spot.column, spot.row);
      paths.push_back(std::move(points));
    }
    for (Points& path : joined(std::move(paths))) {
      const bool closed = isClosed(path);
      traces.push_back({std::move(path), closed});
    }
  }
  return traces;
} catch (const std::bad_alloc&) {
  return failure("memory for finding edges could not be allocated", "", "close other programs");
}

}  // namespace fettle::engine
