#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// The surface of a field as triangles whose corners are samples: all cells in halves, or fewer and larger
/// triangles with no sample farther away than a stated height.
///
/// The fewer ones are a right-triangulated irregular network (W. Evans, D. Kirkpatrick, G. Townsend,
/// "Right-Triangulated Irregular Networks", Algorithmica 30, 2001) over blocks of 256 x 256 cells, without
/// cracks. Difference: a triangle's error is measured at every sample that it covers, not only at the middle
/// of its longest side, so that the stated error is a bound, not an estimate.
///
/// Cells with a hole at a corner have no surface. Threading: const methods from any thread.
class SurfaceMesh {
 public:
  static constexpr std::int32_t kBlock = 256;  ///< cells per side of a block, a power of two
  /// Corner: row * width + column.
  using Triangle = std::array<std::uint64_t, 3>;

  /// `max_error` [height_unit], finite, >= 0; none: every cell. Errors: kCancelled. Takes 8 bytes per sample.
  [[nodiscard]] static Result<SurfaceMesh> create(const Version& field, std::optional<double> max_error,
                                                  JobControl& job);

  /// Calls for each triangle, counter-clockwise seen from above; the same order each time.
  void forEach(const std::function<void(const Triangle&)>& use) const;

  /// Height of a corner [height_unit], the sign applied.
  [[nodiscard]] float height(std::uint64_t corner) const { return heights_[corner]; }
  /// No sample is farther from its triangle than this [height_unit].
  [[nodiscard]] double error() const noexcept { return error_; }

 private:
  struct Point {
    std::int64_t x, y;
  };
  [[nodiscard]] bool inside(Point p) const { return p.x >= 0 && p.y >= 0 && p.x < width_ && p.y < height_; }
  [[nodiscard]] std::uint64_t at(Point p) const { return static_cast<std::uint64_t>(p.y * width_ + p.x); }
  [[nodiscard]] float deviation(Point a, Point b, Point apex) const;
  void measure(Point middle, std::int64_t dx, std::int64_t dy, std::int64_t child);
  Status measureAll(JobControl& job);
  void split(Point a, Point b, Point apex, const std::function<void(const Triangle&)>& use,
             float* largest) const;
  void walk(const std::function<void(const Triangle&)>& use, float* largest) const;

  std::int64_t width_ = 0, height_ = 0;
  std::vector<float> heights_;
  std::vector<float> errors_;  // of the triangles whose longest side has its middle here, and of all below
  std::optional<double> max_error_;
  double error_ = 0.0;
};

}  // namespace fettle::engine
