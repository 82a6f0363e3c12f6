#include "engine/suggest/best_stretches.h"

#include <optional>

#include <glm/geometric.hpp>

namespace fettle::engine {

namespace {

constexpr int kDinkelbachSteps = 20;  // five or six are usual

WorthStretch stretchOf(const GainPath& path, std::size_t first, std::size_t last, const HandPace& pace) {
  WorthStretch found{first, last, path.gains[first], 0.0, 0.0};
  for (std::size_t i = first + 1; i <= last; ++i) {
    found.gain += path.gains[i];
    found.length += glm::distance(path.points[i - 1], path.points[i]);
  }
  found.seconds = pace.seconds(found.length);
  return found;
}

// Of points [begin, end) the stretch of the largest gain less `price` for each second of drawing.
WorthStretch bestAtPrice(const GainPath& path, std::size_t begin, std::size_t end, double price,
                         const HandPace& pace) {
  std::size_t from = begin, first = begin, last = begin;
  double sum = path.gains[begin], most = sum;
  for (std::size_t i = begin + 1; i < end; ++i) {
    const double way = price * glm::distance(path.points[i - 1], path.points[i]) / pace.samples_per_s;
    if (sum > way) {
      sum += path.gains[i] - way;
    } else {
      from = i;
      sum = path.gains[i];
    }
    if (sum > most) {
      most = sum;
      first = from;
      last = i;
    }
  }
  return stretchOf(path, first, last, pace);
}

std::optional<WorthStretch> bestOf(const GainPath& path, std::size_t begin, std::size_t end,
                                   const HandPace& pace) {
  WorthStretch best = bestAtPrice(path, begin, end, 0.0, pace);
  for (int step = 0; step < kDinkelbachSteps && best.gain > 0.0; ++step) {
    const WorthStretch next = bestAtPrice(path, begin, end, best.gain / best.seconds, pace);
    if (!(next.gain / next.seconds > best.gain / best.seconds)) break;
    best = next;
  }
  if (!(best.gain > 0.0)) return std::nullopt;
  return best;
}

// What is too short for a stroke is continued at both ends, as far as the points reach.
WorthStretch atLeast(double shortest, WorthStretch stretch, const GainPath& path, std::size_t begin,
                     std::size_t end, const HandPace& pace) {
  std::size_t first = stretch.first, last = stretch.last;
  double length = stretch.length;
  while (length < shortest && (first > begin || last + 1 < end)) {
    if (first > begin) length += glm::distance(path.points[first], path.points[first - 1]), --first;
    if (last + 1 < end) ++last, length += glm::distance(path.points[last], path.points[last - 1]);
  }
  return first == stretch.first && last == stretch.last ? stretch : stretchOf(path, first, last, pace);
}

}  // namespace

std::vector<WorthStretch> bestStretches(const GainPath& path, const HandPace& pace, double shortest) {
  struct Part {
    std::size_t begin, end;
  };
  std::vector<Part> parts;
  if (!path.points.empty()) parts.push_back({0, path.points.size()});
  std::vector<WorthStretch> found;
  while (!parts.empty()) {
    const Part part = parts.back();
    parts.pop_back();
    const auto core = bestOf(path, part.begin, part.end, pace);
    if (!core) continue;
    const WorthStretch best = atLeast(shortest, *core, path, part.begin, part.end, pace);
    if (best.length >= shortest && best.gain > 0.0) found.push_back(best);
    if (best.last + 1 < part.end) parts.push_back({best.last + 1, part.end});
    if (best.first > part.begin) parts.push_back({part.begin, best.first});
  }
  return found;
}

}  // namespace fettle::engine
