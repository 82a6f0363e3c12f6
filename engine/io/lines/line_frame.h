#pragma once

#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/edge_line.h"
#include "engine/field/grid.h"

namespace fettle::engine {

/// Coordinates of line files and back. Values in long double: a double that is multiplied there and divided again
/// is the same.
struct LineFrame {
  using Real = long double;

  Real unit_x = 1, unit_y = 1;      ///< of the file, in one sample
  Real origin_x = 0, origin_y = 0;  ///< of sample (0, 0), in the file
  Real sample_mm = 1;               ///< across a line
  Real height_mm = 1;               ///< in one height unit

  /// Field coordinates [mm], of strokes and CSV files.
  [[nodiscard]] static LineFrame field(const Grid& grid);
  /// The scan's own: world coordinates if it has a coordinate system, else these in millimetres.
  [[nodiscard]] static LineFrame world(const Grid& grid);

  [[nodiscard]] Real x(double column) const noexcept { return origin_x + Real{column} * unit_x; }
  [[nodiscard]] Real y(double row) const noexcept { return origin_y + Real{row} * unit_y; }
  /// [samples], rounded to a multiple of 2^-20.
  [[nodiscard]] glm::dvec2 position(Real x, Real y) const noexcept;

  [[nodiscard]] Real slope() const noexcept { return height_mm / sample_mm; }
};

/// Collects the lines of a file: checks them and inserts points.
class LineCollector {
 public:
  /// `job`, which may be null, cancels add().
  LineCollector(const Grid& grid, const std::string& path, const JobControl* job = nullptr)
      : grid_(grid), path_(path), job_(job) {}

  void begin(std::int64_t id, bool closed) { lines_.push_back({id, closed, {}}); }
  [[nodiscard]] bool empty() const noexcept { return lines_.empty(); }
  /// The line that was begun last.
  [[nodiscard]] EdgeLine& last() noexcept { return lines_.back(); }

  /// `where` names the place in the file, such as "line 7". Errors as importLines.
  [[nodiscard]] Status add(const EdgePoint& point, const std::string& where);
  /// Inserts what is missing between the last point of each closed line and its first. Call once, last.
  [[nodiscard]] Result<std::vector<EdgeLine>> finish();

 private:
  [[nodiscard]] Status insertUpTo(EdgeLine& line, const EdgePoint& next);
  [[nodiscard]] Status reserve(double more);

  const Grid& grid_;
  const std::string& path_;
  const JobControl* job_;
  std::vector<EdgeLine> lines_;
  double points_ = 0.0;
};

}  // namespace fettle::engine
