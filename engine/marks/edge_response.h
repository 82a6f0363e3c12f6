#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/job.h"
#include "engine/field/reader.h"
#include "engine/marks/edge_kernels.h"
#include "engine/marks/surface_derivatives.h"
#include "engine/marks/whole_surface.h"

namespace fettle::engine {

/// Edge response of each sample of a block, of two kinds, at one scale:
///
///   step    the slope at the sample, minus the slope of the surface two sigma before and behind it along the
///           steepest way: a step is steeper than its surroundings, a tilted plane or a bend is not
///   crease  the larger principal curvature: a ridge, a groove, the foot of a chamfer
///
/// Both are 0 on every plane, whatever its tilt. [height unit per sample], and per square sample.
///
/// Of the surface without lone outliers, continued over holes (whole_surface.h); the weight of a sample is the
/// share of its surroundings that is not filled in.
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
  void measure(int columns, int rows);

  Scatter scatter_;
  int side_;  // distance along the slope at which the surroundings are sampled
  EdgeKernels kernels_;
  WholeSurface surface_;
  SurfaceDerivatives derivatives_;
  int margin_;  // of the surface around the block: slope at the side, its kernel, holes
};

}  // namespace fettle::engine
