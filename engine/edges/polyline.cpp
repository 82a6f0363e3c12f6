#include "engine/edges/polyline.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fettle::engine {

namespace {

constexpr double kLeastClosed = 8.0;  // [samples]

double apart(glm::dvec2 a, glm::dvec2 b) {
  return std::hypot(b.x - a.x, b.y - a.y);
}

}  // namespace

double lengthOf(const std::vector<glm::dvec2>& points, bool closed) {
  double length = closed && points.size() > 1 ? apart(points.back(), points.front()) : 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) length += apart(points[i - 1], points[i]);
  return length;
}

Polyline resampled(const Polyline& line) {
  Polyline even;
  even.closed = line.closed;
  even.period = line.period;
  const std::size_t n = line.points.size();
  if (n == 0) return even;
  const double length = lengthOf(line.points, line.closed);
  const int pieces = std::max(1, static_cast<int>(std::lround(length)));
  // A closed line does not repeat its first point; a line without length is one point.
  const int count = length <= 0.0 ? 1 : line.closed ? pieces : pieces + 1;
  even.points.reserve(static_cast<std::size_t>(count));
  even.origins.reserve(static_cast<std::size_t>(count));
  std::size_t segment = 0;
  double begin = 0.0;  // of the segment, along the line
  const auto end = [&](std::size_t i) { return (i + 1) % n; };
  const std::size_t segments = line.closed ? n : n - 1;
  double extent = segments > 0 ? apart(line.points[0], line.points[end(0)]) : 0.0;
  for (int k = 0; k < count; ++k) {
    const double place = length * k / pieces;
    while (segment + 1 < segments && place > begin + extent) {
      begin += extent;
      ++segment;
      extent = apart(line.points[segment], line.points[end(segment)]);
    }
    const double t = extent > 0.0 ? std::clamp((place - begin) / extent, 0.0, 1.0) : 0.0;
    const std::size_t next = segments > 0 ? end(segment) : 0;
    even.points.push_back(line.points[segment] + (line.points[next] - line.points[segment]) * t);
    const double next_origin = segment + 1 == n ? line.period : line.origins[next];
    even.origins.push_back(line.origins[segment] + (next_origin - line.origins[segment]) * t);
  }
  return even;
}

Polyline polylineOf(const std::vector<glm::dvec2>& stroke, bool closed) {
  Polyline line;
  line.closed = closed && lengthOf(stroke, true) >= kLeastClosed;
  line.points = stroke;
  line.origins.resize(stroke.size());
  line = resampled(line);
  std::iota(line.origins.begin(), line.origins.end(), 0.0);
  line.period = static_cast<double>(line.points.size());
  return line;
}

std::vector<glm::dvec2> smoothed(const Polyline& line, double deviation) {
  const int n = line.size();
  const int radius = static_cast<int>(std::ceil(3.0 * deviation));
  std::vector<double> weights(static_cast<std::size_t>(radius) + 1);
  for (int k = 0; k <= radius; ++k)
    weights[static_cast<std::size_t>(k)] = std::exp(-0.5 * k * k / (deviation * deviation));
  std::vector<glm::dvec2> smooth(line.points.size());
  for (int i = 0; i < n; ++i) {
    // Near the ends of an open line the window shrinks, so that it stays symmetric and shifts nothing along.
    const int r = line.closed ? std::min(radius, (n - 1) / 2) : std::min({radius, i, n - 1 - i});
    glm::dvec2 sum(0.0);
    double weight = 0.0;
    for (int k = -r; k <= r; ++k) {
      const double w = weights[static_cast<std::size_t>(std::abs(k))];
      sum += line.points[static_cast<std::size_t>(line.wrapped(i + k))] * w;
      weight += w;
    }
    smooth[static_cast<std::size_t>(i)] = sum / weight;
  }
  return smooth;
}

std::vector<glm::dvec2> tangentsOf(const Polyline& line, int half) {
  const int n = line.size();
  std::vector<glm::dvec2> tangents(line.points.size(), glm::dvec2(1.0, 0.0));
  for (int i = 0; i < n; ++i) {
    const int before = line.closed ? line.wrapped(i - half) : std::max(i - half, 0);
    const int after = line.closed ? line.wrapped(i + half) : std::min(i + half, n - 1);
    const glm::dvec2 run =
        line.points[static_cast<std::size_t>(after)] - line.points[static_cast<std::size_t>(before)];
    const double length = std::hypot(run.x, run.y);
    if (length > 1e-9) tangents[static_cast<std::size_t>(i)] = run / length;
  }
  return tangents;
}

glm::dvec2 pointAt(const Polyline& line, double index) {
  const auto i = std::min(static_cast<std::size_t>(std::max(index, 0.0)), line.points.size() - 1);
  const double t = index - static_cast<double>(i);
  const std::size_t next = i + 1 < line.points.size() ? i + 1 : line.closed ? 0 : i;
  return line.points[i] + (line.points[next] - line.points[i]) * t;
}

}  // namespace fettle::engine
