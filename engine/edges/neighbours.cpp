#include "engine/edges/neighbours.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <tbb/parallel_for.h>

namespace fettle::engine {

namespace {

constexpr double kBesideNormal = 0.8;  // points are about one sample apart, so that a passage has one or two
constexpr double kSteepest = 0.5;      // cosine of the angle at which a line crosses and is no neighbour
constexpr int kSamePassage = 6;        // points of one line nearer than this belong to one passage
// The majority vote of sideOf: points before and after, and what counts as the same passage there.
constexpr int kVoters = 40;
constexpr int kVoterStep = 2;
constexpr double kClearSide = 5.0;  // farther neighbours are on the side where they are [samples]
constexpr double kSameOffset = 6.0;

bool runsAlong(const Polyline& line, int i, glm::dvec2 tangent) {
  constexpr int kHalf = 2;
  const int n = line.size();
  const int before = line.closed ? line.wrapped(i - kHalf) : std::max(i - kHalf, 0);
  const int after = line.closed ? line.wrapped(i + kHalf) : std::min(i + kHalf, n - 1);
  const glm::dvec2 run =
      line.points[static_cast<std::size_t>(after)] - line.points[static_cast<std::size_t>(before)];
  return std::abs(run.x * tangent.x + run.y * tangent.y) >= kSteepest * std::hypot(run.x, run.y);
}

}  // namespace

LineIndex::LineIndex(const std::vector<Polyline>& lines) : lines_(lines) {
  for (std::size_t k = 0; k < lines.size(); ++k)
    for (std::size_t i = 0; i < lines[k].points.size(); ++i) {
      const glm::dvec2 point = lines[k].points[i];
      entries_.push_back({static_cast<int>(std::floor(point.x / kCell)),
                          static_cast<int>(std::floor(point.y / kCell)), static_cast<int>(k),
                          static_cast<int>(i)});
    }
  std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
    return std::tie(a.up, a.across, a.line, a.point) < std::tie(b.up, b.across, b.line, b.point);
  });
}

std::vector<Neighbour> LineIndex::around(int own, int i, glm::dvec2 tangent, double depth) const {
  const Polyline& line = lines_[static_cast<std::size_t>(own)];
  const glm::dvec2 centre = line.points[static_cast<std::size_t>(i)];
  const auto cell = [](double x) { return static_cast<int>(std::floor(x / kCell)); };
  std::vector<Neighbour> all;
  for (int up = cell(centre.y - depth); up <= cell(centre.y + depth); ++up) {
    const int last = cell(centre.x + depth);
    auto entry = std::lower_bound(entries_.begin(), entries_.end(), std::pair(up, cell(centre.x - depth)),
                                  [](const Entry& a, const std::pair<int, int>& cell_of) {
                                    return std::pair(a.up, a.across) < cell_of;
                                  });
    for (; entry != entries_.end() && entry->up == up && entry->across <= last; ++entry) {
      if (entry->line == own && line.stepsBetween(i, entry->point) < 3.0 * depth) continue;
      const glm::dvec2 to =
          lines_[static_cast<std::size_t>(entry->line)].points[static_cast<std::size_t>(entry->point)] -
          centre;
      const double s = to.x * tangent.x + to.y * tangent.y;
      const double d = to.y * tangent.x - to.x * tangent.y;
      if (std::abs(s) <= kBesideNormal && std::abs(d) < depth - 0.5 &&
          runsAlong(lines_[static_cast<std::size_t>(entry->line)], entry->point, tangent))
        all.push_back({d, entry->line, entry->point});
    }
  }
  std::sort(all.begin(), all.end(), [](const Neighbour& a, const Neighbour& b) {
    return std::tie(a.offset, a.line, a.point) < std::tie(b.offset, b.line, b.point);
  });
  std::vector<Neighbour> once;
  for (const Neighbour& next : all)
    if (std::none_of(once.begin(), once.end(), [&](const Neighbour& b) {
          return b.line == next.line &&
                 lines_[static_cast<std::size_t>(b.line)].stepsBetween(b.point, next.point) < kSamePassage;
        }))
      once.push_back(next);
  return once;
}

LineNeighbours neighboursOf(const LineIndex& index, int own, const std::vector<glm::dvec2>& tangents,
                            double depth) {
  LineNeighbours neighbours(tangents.size());
  tbb::parallel_for(std::size_t{0}, tangents.size(), [&](std::size_t i) {
    neighbours[i] = index.around(own, static_cast<int>(i), tangents[i], depth);
  });
  return neighbours;
}

double sideOf(const Polyline& line, const LineNeighbours& neighbours, int i, const Neighbour& neighbour) {
  if (std::abs(neighbour.offset) >= kClearSide) return neighbour.offset;
  double sum = 0.0;
  int count = 0;
  for (int along = -kVoters; along <= kVoters; along += kVoterStep) {
    const int j = line.wrapped(i + along);
    if (j < 0) continue;
    for (const Neighbour& voter : neighbours[static_cast<std::size_t>(j)])
      if (voter.line == neighbour.line && std::abs(voter.offset - neighbour.offset) < kSameOffset) {
        sum += voter.offset;
        ++count;
      }
  }
  return sum / count;  // the neighbour itself is one of them
}

}  // namespace fettle::engine
