#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

namespace fettle::engine {

// Edge lines: where two surfaces of a part meet. Positions are sample coordinates, (column, row): sample centres
// are at whole numbers.

/// Which of the changes at a line stands out more from its uncertainty: a guess. Right at 98 % of the located points
/// of simulated parts.
enum class LineKind : std::uint8_t {
  kStep,    ///< the height jumps
  kCrease,  ///< the slope changes
};

/// One point of a line. "Left" is left going along the points, with columns to the right and rows up; "across"
/// is along the normal of the line, in samples.
struct EdgePoint {
  glm::dvec2 position{0.0};  ///< [samples], a multiple of 2^-20
  /// Whether the field shows an edge here, see locateEdgeLines(). If not, the position is that of the hand, and
  /// the remaining members are 0: the point is a plain mark.
  bool located = false;
  LineKind kind = LineKind::kStep;
  double deviation = 0.0;  ///< standard deviation of the position across the line [samples]
  /// Height of the left surface minus that of the right one, at the line, and its standard deviation
  /// [height_unit].
  double step = 0.0;
  double step_deviation = 0.0;
  /// Slope across the line, towards the left: left surface minus right surface, and its standard deviation
  /// [height_unit per sample].
  double slope_change = 0.0;
  double slope_deviation = 0.0;
};

/// A line: of one stroke.
struct EdgeLine {
  static constexpr double kMostApart = 2.0;

  std::int64_t id = 0;
  bool closed = false;
  /// At most kMostApart from one to the next [samples]; empty for a stroke without points.
  std::vector<EdgePoint> points;
};

/// Points of all lines.
[[nodiscard]] inline std::int64_t countPoints(std::span<const EdgeLine> lines) noexcept {
  std::int64_t points = 0;
  for (const EdgeLine& line : lines) points += static_cast<std::int64_t>(line.points.size());
  return points;
}

/// The edge lines of a field, immutable and shared by the versions that have the same ones; null for none.
using EdgeLines = std::shared_ptr<const std::vector<EdgeLine>>;

}  // namespace fettle::engine
