#include "engine/edges/strip.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace fettle::engine {

namespace {

// A sample belongs to its nearest point, so that it is at most half a sample along from it where the line is
// straight. On the outer side of a bend it is farther; there only its distance counts.
constexpr double kAlongUsual = 1.5;  // [samples]
constexpr double kAlongMost = 2.5;   // at the ends of a line, and close to it
constexpr double kClose = 3.0;

struct Place {
  SampleWindow::Index index = 0;
  int column = 0, row = 0;
};

// Notes in the window which point of `line` is nearest to each sample within `depth`; returns these samples.
std::vector<Place> assignNearest(const Polyline& line, SampleWindow& window, double depth) {
  std::vector<Place> places;
  const int reach = static_cast<int>(std::ceil(depth));
  const auto most = static_cast<float>(depth * depth + 1.0);
  for (int i = 0; i < line.size(); ++i) {
    const glm::dvec2 centre = line.points[static_cast<std::size_t>(i)];
    window.forEachAround(centre, reach, [&](SampleWindow::Index index, int column, int row) {
      const auto x = static_cast<float>(column - centre.x), y = static_cast<float>(row - centre.y);
      const float distance = x * x + y * y;
      SampleWindow::Sample& sample = window.at(index);
      if (distance > most || distance >= sample.nearest_distance) return;
      if (sample.nearest_distance == SampleWindow::kNoFit) places.push_back({index, column, row});
      sample.nearest_distance = distance;
      sample.nearest = i;
    });
  }
  return places;
}

// The middle one of the heights: a spike does not shift it.
double middleHeight(const SampleWindow& window, const std::vector<Place>& places) {
  std::vector<float> heights;
  heights.reserve(places.size());
  for (const Place& place : places)
    if (window.at(place.index).kept) heights.push_back(window.at(place.index).height);
  if (heights.empty()) return 0.0;
  const auto upper = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), upper, heights.end());
  // The mean of the two middle ones: upside down it is the same height.
  const float lower = heights.size() % 2 == 1 ? *upper : *std::max_element(heights.begin(), upper);
  return 0.5 * (double{lower} + double{*upper});
}

// Coordinates of a sample `offset` from its nearest point; nothing where it lies beyond an end of the line.
std::optional<StripSample> inStrip(glm::dvec2 offset, glm::dvec2 tangent, bool at_end) {
  StripSample sample;
  sample.s = offset.x * tangent.x + offset.y * tangent.y;
  sample.d = offset.y * tangent.x - offset.x * tangent.y;
  if (std::abs(sample.s) <= kAlongUsual) return sample;
  const double distance = std::hypot(offset.x, offset.y);
  if (at_end || distance < kClose) {
    if (std::abs(sample.s) > kAlongMost) return std::nullopt;
    return sample;
  }
  sample.d = std::copysign(distance, sample.d);
  sample.s = 0.0;
  return sample;
}

}  // namespace

Strip stripAlong(const Polyline& line, SampleWindow& window, double depth, int tangent_half) {
  Strip strip;
  strip.depth = depth;
  strip.tangents = tangentsOf(line, tangent_half);
  const std::vector<Place> places = assignNearest(line, window, depth);
  strip.reference = middleHeight(window, places);

  std::vector<StripSample> samples;
  std::vector<std::size_t> owners;
  samples.reserve(places.size());
  owners.reserve(places.size());
  strip.first.assign(line.points.size() + 1, 0);
  for (const Place& place : places) {
    SampleWindow::Sample& known = window.at(place.index);
    known.nearest_distance = SampleWindow::kNoFit;
    if (std::isnan(known.height)) continue;
    const auto i = static_cast<std::size_t>(known.nearest);
    const bool at_end = !line.closed && (i == 0 || i + 1 == line.points.size());
    const glm::dvec2 offset = glm::dvec2(place.column, place.row) - line.points[i];
    std::optional<StripSample> sample = inStrip(offset, strip.tangents[i], at_end);
    if (!sample) continue;
    sample->index = place.index;
    sample->column = place.column;
    sample->row = place.row;
    sample->z = double{known.height} - strip.reference;
    samples.push_back(*sample);
    owners.push_back(i);
    ++strip.first[i + 1];
  }
  for (std::size_t i = 1; i < strip.first.size(); ++i) strip.first[i] += strip.first[i - 1];
  std::vector<std::size_t> next(strip.first.begin(), strip.first.end() - 1);
  strip.samples.resize(samples.size());
  for (std::size_t k = 0; k < samples.size(); ++k) strip.samples[next[owners[k]]++] = samples[k];
  return strip;
}

}  // namespace fettle::engine
