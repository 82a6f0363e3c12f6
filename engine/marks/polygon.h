#pragma once

#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/marks/change_marks.h"

namespace fettle::engine {

/// A closed line in the field's plane, for marking what lies inside: corners in samples (x = column,
/// y = row), the last one joined to the first.
///
/// A corner is rounded to the nearest 1/256 of a sample and clamped to within 2^20 samples of the origin; all
/// further arithmetic is exact in integers. A sample is inside by the even-odd rule: a ray from it to the
/// right crosses the line an odd number of times. A line that crosses itself leaves out regions it encloses
/// twice. A sample on the line itself belongs to it on a left or lower side and not on a right or upper one,
/// so that two polygons with a common side share no sample and leave none out. Shimrat, Algorithm 112 (1962).
class Polygon {
 public:
  /// Corners that are not finite are left out.
  explicit Polygon(std::span<const glm::dvec2> corners_samples);

  /// Whether no sample can be inside: fewer than three corners, or no area between any two rows.
  [[nodiscard]] bool empty() const noexcept { return edges_.empty(); }
  /// The tiles of the field that may hold samples inside.
  [[nodiscard]] TileRange tiles(const Grid& grid) const noexcept;
  /// The samples of one tile that are inside. Time is proportional to the sides that cross the tile's rows.
  [[nodiscard]] MarkRows inside(std::int32_t tile_column, std::int32_t tile_row) const;

  static constexpr int kSteps = 256;  ///< of a corner in one sample

 private:
  // A side that is not level, by its lower end; in 1/256 sample.
  struct Edge {
    std::int64_t x, y;    // lower end
    std::int64_t dx, dy;  // dy > 0
  };
  std::vector<Edge> edges_;  // by the row of their lower end
  std::int64_t low_x_ = 0, high_x_ = 0, low_y_ = 0, high_y_ = 0;
  std::vector<std::int64_t> highest_;  // maximum over the edges up to each one: where a search may stop
};

/// Marks or unmarks all samples inside. Errors as changeMarks; an empty polygon changes nothing.
[[nodiscard]] Result<Version> markPolygon(const Version& field, const Polygon& polygon, MarkChange change,
                                          JobControl& job);

}  // namespace fettle::engine
