#include "engine/suggest/continued_paths.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include <glm/geometric.hpp>

namespace fettle::engine {

namespace {

using Path = std::vector<glm::dvec2>;

constexpr double kCorner = 16.0, kGap = 120.0;  // [samples]
constexpr double kSharpest = -0.3;      // cosine of the turn at a corner: a little more than a right angle
constexpr double kAhead = 0.92;         // cosine of the angle between an end and its way over a gap
constexpr std::size_t kDirection = 12;  // points that give the direction of an end
constexpr auto kFree = std::numeric_limits<std::size_t>::max();

// An end of a path: its number is twice the path's, plus one at the back.
struct PathEnd {
  std::size_t number = 0;
  glm::dvec2 at{0.0}, outwards{0.0};
};

PathEnd endOf(const Path& path, std::size_t number) {
  const bool back = number % 2 != 0;
  const std::size_t n = std::min(kDirection, path.size() - 1);
  const glm::dvec2 at = back ? path.back() : path.front();
  const glm::dvec2 way = at - (back ? path[path.size() - 1 - n] : path[n]);
  const double length = glm::length(way);
  return {number, at, length > 0.0 ? way / length : glm::dvec2(0.0)};
}

bool mayJoin(const PathEnd& a, const PathEnd& b, double gap) {
  if (gap <= kCorner) return -glm::dot(a.outwards, b.outwards) >= kSharpest;
  const glm::dvec2 way = (b.at - a.at) / gap;
  return gap <= kGap && glm::dot(a.outwards, way) >= kAhead && glm::dot(b.outwards, -way) >= kAhead;
}

struct PathJoint {
  double cost = 0.0;
  std::size_t first = 0, second = 0;  // ends
};

std::vector<PathJoint> jointsOf(const std::vector<Path>& paths) {
  std::vector<PathEnd> ends;
  for (std::size_t i = 0; i < paths.size(); ++i)
    for (const std::size_t number : {2 * i, 2 * i + 1}) ends.push_back(endOf(paths[i], number));
  std::ranges::sort(ends, {}, [](const PathEnd& end) { return std::tuple(end.at.x, end.number); });
  std::vector<PathJoint> joints;
  for (std::size_t i = 0; i < ends.size(); ++i)
    for (std::size_t k = i + 1; k < ends.size() && ends[k].at.x - ends[i].at.x <= kGap; ++k) {
      const PathEnd &a = ends[i], &b = ends[k];
      const double gap = glm::distance(a.at, b.at);
      if (a.number / 2 == b.number / 2 || !mayJoin(a, b, gap)) continue;
      const double turn = 2.0 + glm::dot(a.outwards, b.outwards);
      joints.push_back({gap * turn, std::min(a.number, b.number), std::max(a.number, b.number)});
    }
  std::ranges::sort(joints, {}, [](const PathJoint& j) { return std::tuple(j.cost, j.first, j.second); });
  return joints;
}

void append(const Path& path, Path& chain) {
  if (!chain.empty()) {
    const glm::dvec2 from = chain.back(), way = path.front() - from;
    const int pieces = static_cast<int>(std::ceil(glm::length(way)));
    for (int i = 1; i < pieces; ++i) chain.push_back(from + way * (static_cast<double>(i) / pieces));
  }
  chain.insert(chain.end(), path.begin(), path.end());
}

}  // namespace

std::vector<Path> continuedPaths(std::vector<Path> paths) {
  std::erase_if(paths, [](const Path& path) { return path.empty(); });
  std::vector<std::size_t> other(2 * paths.size(), kFree);  // the end that an end is joined with
  std::vector<std::size_t> group(paths.size());
  std::iota(group.begin(), group.end(), std::size_t{0});
  const auto groupOf = [&](std::size_t path) {
    while (group[path] != path) path = group[path] = group[group[path]];
    return path;
  };
  for (const PathJoint& joint : jointsOf(paths)) {
    const std::size_t a = groupOf(joint.first / 2), b = groupOf(joint.second / 2);
    if (a == b || other[joint.first] != kFree || other[joint.second] != kFree) continue;
    group[std::max(a, b)] = std::min(a, b);
    other[joint.first] = joint.second;
    other[joint.second] = joint.first;
  }
  std::vector<Path> chains;
  std::vector<bool> done(paths.size(), false);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    if (done[i] || (other[2 * i] != kFree && other[2 * i + 1] != kFree)) continue;
    Path chain;
    // From a free end through each path to its other end.
    for (std::size_t end = other[2 * i] == kFree ? 2 * i : 2 * i + 1; end != kFree; end = other[end ^ 1U]) {
      Path path = std::move(paths[end / 2]);
      done[end / 2] = true;
      if (end % 2 != 0) std::ranges::reverse(path);
      append(path, chain);
    }
    chains.push_back(std::move(chain));
  }
  return chains;
}

}  // namespace fettle::engine
