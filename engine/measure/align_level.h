#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include <Eigen/Dense>

#include "engine/measure/height_map.h"
#include "engine/measure/rigid_motion.h"

namespace fettle::engine {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// One resolution at which alignFields() compares two fields: places of the first, and the second as a smooth surface, both
/// through one Gaussian window. Lengths in millimetres. Threading: const functions from any thread, on all workers of the
/// calling arena; bit-identical for any number of them.
class AlignLevel {
 public:
  /// Of the field in each direction, over which standard errors are taken.
  static constexpr int kBlocks = 12;

  /// A place of the first map: position, smoothed height and slopes.
  struct Point {
    double x, y, z, slope_x, slope_y;
    std::int32_t column, row;  ///< of the places that are used
    std::int32_t block;        ///< row-major, of kBlocks x kBlocks
  };

  /// What a motion makes of the second surface under a point.
  struct Under {
    /// Height of the first less that of the second; NaN where there is none.
    double residual = std::numeric_limits<double>::quiet_NaN();
    double slope_x = 0.0, slope_y = 0.0, z = 0.0;  ///< of the second, moved
  };

  /// Every n-th place of a map in each direction is used, so that these are 300,000 at most.
  [[nodiscard]] static std::int32_t strideFor(std::size_t places) noexcept;

  /// `sigma`: of the window. At most 300,000 places are used. Throws std::bad_alloc.
  AlignLevel(const HeightMap& first, const HeightMap& second, double sigma);

  [[nodiscard]] const std::vector<Point>& points() const noexcept { return points_; }
  /// About so many of `points` points have noise of their own: their area over that of the window's correlation.
  [[nodiscard]] double independent(std::size_t points) const noexcept {
    return static_cast<double>(points) * step_x_ * step_y_ / (4.0 * std::numbers::pi * sigma_ * sigma_);
  }
  [[nodiscard]] double leastSpacing() const noexcept { return least_spacing_; }

  /// Sum over pairs of points of x_i x_j r_ij, with the correlation r that the window gives noise which samples do not
  /// share: exp(-d^2 / 4 sigma^2). All pairs, or those within a block. x of points that do not count are 0.
  enum class Pairs : std::uint8_t { kAll, kWithinBlocks };
  [[nodiscard]] Matrix6 correlatedSum(const std::vector<Vector6>& x, Pairs pairs) const;

  /// For each point what lies under it when the second surface is moved.
  [[nodiscard]] std::vector<Under> under(const RigidMotion& motion) const;

 private:
  double sigma_ = 0.0, step_x_ = 1.0, step_y_ = 1.0, least_spacing_ = 1.0;
  std::int32_t columns_ = 0, rows_ = 0;  // of the places that are used
  std::vector<std::int32_t> block_of_column_, block_of_row_;
  MapSpline spline_;
  std::vector<Point> points_;
};

}  // namespace fettle::engine
