#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/edges/polyline.h"
#include "engine/edges/sample_window.h"

namespace fettle::engine {

/// A sample next to a line, in the coordinates of its nearest point: d across, positive to the left, s along.
struct StripSample {
  SampleWindow::Index index = 0;
  double d = 0.0, s = 0.0;  ///< [samples]
  double z = 0.0;           ///< height above Strip::reference [height_unit]
  int column = 0, row = 0;  ///< in the coordinates of the SampleWindow
};

/// Offsets that belong to a point of a line: beyond them lie the surfaces of neighbouring lines. [samples]
struct OffsetRange {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool contains(double d) const noexcept { return d >= low && d <= high; }
};

/// All samples within `depth` of a line, each at its nearest point of the line.
struct Strip {
  double depth = 0.0;      ///< [samples]
  double reference = 0.0;  ///< a height near the line [height_unit]
  std::vector<glm::dvec2> tangents;
  std::vector<StripSample> samples;  ///< ordered by point
  std::vector<std::size_t> first;    ///< of each point, and the end

  [[nodiscard]] std::span<const StripSample> at(int point) const noexcept {
    const auto i = static_cast<std::size_t>(point);
    return {samples.data() + first[i], first[i + 1] - first[i]};
  }
  [[nodiscard]] glm::dvec2 normal(int point) const noexcept {
    const glm::dvec2 t = tangents[static_cast<std::size_t>(point)];
    return {-t.y, t.x};
  }
};

/// The strip of a line; tangents from `tangent_half` points before and after. Holes are left out; samples that
/// are not kept are included.
[[nodiscard]] Strip stripAlong(const Polyline& line, SampleWindow& window, double depth, int tangent_half);

/// Calls visit(sample, s, j) for the kept samples of the points j = i - half .. i + half of a line, with s counted
/// from point i and `ranges` the offsets that count at each point.
template <class Visit>
void forEachKept(const Polyline& line, const Strip& strip, const SampleWindow& window,
                 const std::vector<OffsetRange>& ranges, int i, int half, Visit&& visit) {
  if (line.closed && 2 * half + 1 > line.size()) half = (line.size() - 1) / 2;
  for (int along = -half; along <= half; ++along) {
    const int j = line.wrapped(i + along);
    if (j < 0) continue;
    const OffsetRange range = ranges[static_cast<std::size_t>(j)];
    for (const StripSample& sample : strip.at(j))
      if (window.at(sample.index).kept && range.contains(sample.d)) visit(sample, sample.s + along, j);
  }
}

}  // namespace fettle::engine
