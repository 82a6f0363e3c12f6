#pragma once

#include <cstddef>
#include <vector>

#include <glm/vec2.hpp>

namespace fettle::engine {

/// A line of points about one sample apart, derived from a stroke. [samples] throughout.
struct Polyline {
  std::vector<glm::dvec2> points;
  /// Where each point came from: its place on the first Polyline of the stroke, as an index with a fraction;
  /// increasing.
  std::vector<double> origins;
  double period = 0.0;  ///< of a closed line: what the origins increase by once around it
  bool closed = false;

  [[nodiscard]] int size() const noexcept { return static_cast<int>(points.size()); }
  /// Index `i` wrapped around a closed line, -1 outside an open one.
  [[nodiscard]] int wrapped(int i) const noexcept {
    const int n = size();
    if (i >= 0 && i < n) return i;
    return closed && n > 0 ? ((i % n) + n) % n : -1;
  }
  /// Steps along the line between two of its points, the shorter way round a closed one.
  [[nodiscard]] int stepsBetween(int i, int j) const noexcept {
    const int apart = i < j ? j - i : i - j;
    return closed && size() - apart < apart ? size() - apart : apart;
  }
};

/// The line of a stroke, resampled; `origins` are its own indices. Repeated points count once. A closed stroke
/// shorter than 8 samples is taken as open.
[[nodiscard]] Polyline polylineOf(const std::vector<glm::dvec2>& stroke, bool closed);

/// Evenly spaced points on `line`, as near to one sample apart as its length allows, both ends included.
[[nodiscard]] Polyline resampled(const Polyline& line);

/// Gaussian along the line, `deviation` in points, > 0. The ends of an open line stay where they are.
[[nodiscard]] std::vector<glm::dvec2> smoothed(const Polyline& line, double deviation);

/// Unit tangents, from the points `half` before and after each. (1, 0) where these coincide.
[[nodiscard]] std::vector<glm::dvec2> tangentsOf(const Polyline& line, int half);

/// The point of `line` at an index with a fraction, as `origins` state it.
[[nodiscard]] glm::dvec2 pointAt(const Polyline& line, double index);

/// Length of the closed or open line through `points`.
[[nodiscard]] double lengthOf(const std::vector<glm::dvec2>& points, bool closed);

}  // namespace fettle::engine
