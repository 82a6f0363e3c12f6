#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/base/job.h"
#include "engine/field/reader.h"
#include "engine/filter/median.h"
#include "engine/marks/edge_kernels.h"

namespace fettle::engine {

/// Edge response of each sample of a block, of two kinds, at one scale:
///
///   step    the slope at the sample, minus the slope of the surface two sigma before and behind it along the
///           steepest way: a step is steeper than its surroundings, a tilted plane or a bend is not
///   crease  the larger principal curvature: a ridge, a groove, the foot of a chamfer
///
/// Both are 0 on every plane, whatever its tilt. [height unit per sample], and per square sample.
///
/// Single outliers are replaced by the median of their 3 x 3 (5 x 5 from sigma 1.5 on) surroundings, by the
/// rule of Hampel (1974), which leaves all others as they are. Holes, and what lies beyond the border, are
/// continued as the plane through what is around them
/// (weighted least squares); the weight of a sample is the share of its surroundings that is not filled in.
class EdgeResponse {
 public:
  /// `sigma` in samples, kSmallestSigma .. kLargestSigma.
  enum class Scatter : std::uint8_t { kLeave, kMeasure };  ///< whether step_in_x .. bend_in_y are filled
  explicit EdgeResponse(double sigma, Scatter scatter = Scatter::kLeave);

  static constexpr double kSmallestSigma = 0.7;
  static constexpr double kLargestSigma = 8.0;

  /// Computes [column, column + columns) x [row, row + rows), which may reach beyond the field. Results
  /// depend on how a field is divided only by rounding. False when cancelled. Throws std::bad_alloc.
  /// Threading: one thread at a time; each thread needs its own object.
  [[nodiscard]] bool run(const FieldReader& field, std::int32_t column, std::int32_t row, int columns,
                         int rows, const JobControl& job);

  // Of the last run, columns x rows, row-major.
  std::vector<float> step, crease;        ///< >= 0; 0 for a hole
  std::vector<float> step_x, step_y;      ///< unit vector across the step; 0, 0 where there is no slope
  std::vector<float> crease_x, crease_y;  ///< unit vector across the crease
  /// With Scatter::kMeasure: both along x alone and along y alone, with their signs. Linear in the heights,
  /// so their scatter is that of the noise, for any tilt of the surface.
  std::vector<float> step_in_x, step_in_y, bend_in_x, bend_in_y;
  std::vector<std::uint8_t> whole;  ///< 1: a sample without hole or border near it

 private:
  [[nodiscard]] bool read(const FieldReader& field, const JobControl& job);
  void fill();
  void differentiate();
  void measure(int columns, int rows);
  [[nodiscard]] std::size_t at(int c, int r) const noexcept {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(wide_) + static_cast<std::size_t>(c);
  }

  double sigma_;
  EdgeKernels kernels_;
  Scatter scatter_;
  int side_ = 1;  // distance along the slope at which the surroundings are sampled
  std::unique_ptr<BlockFilter> median_;
  int median_reach_ = 1;
  int fill_reach_ = 1;

  // The block with a margin on all sides, wide_ x tall_ from (first_column_, first_row_) of the field.
  std::int32_t first_column_ = 0, first_row_ = 0;
  int wide_ = 0, tall_ = 0;
  int margin_ = 0;
  bool holes_ = false;
  std::vector<float> raw_, middle_, rest_, spread_, z_, smooth_rows_, first_rows_, second_rows_;
  std::vector<float> gx_, gy_, hxx_, hxy_, hyy_, share_;
  std::vector<std::uint8_t> valid_;
  std::vector<std::int32_t> counts_;
};

}  // namespace fettle::engine
