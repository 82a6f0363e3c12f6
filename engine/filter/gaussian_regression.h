#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "engine/base/job.h"
#include "engine/field/reader.h"
#include "engine/field/sample_rect.h"
#include "engine/filter/gaussian_plane.h"
#include "engine/simd/cpu.h"

namespace fettle::engine {

/// An axis of GaussianRegression: how the samples' weights come to nodes, and from there what the moments at a sample need.
///
/// A moment of order k, the sum of weights times g(d) (d / s)^k, g the Gaussian of standard deviation s, is worked out of the same
/// sums at nodes as the sum of order 0: if g is a Gaussian o and then a Gaussian e, the last one, one after the other, it is what
///
///     t^k He_k(d / v) e(d),      t = s_o / s_e,  v = s_o s_e / s,      s^2 = s_o^2 + s_e^2
///
/// makes of the sums that o leaves: x of N(m, v^2) has the mean m^k of v^k He_k(x / v), He_k the polynomials of Hermite.
struct RegressionAxis {
  static constexpr std::size_t kOrders = 5;

  /// Of a Gaussian that is sums of samples at nodes, or none; its `up` is not used. Weights end at 1.25 cut-offs: 2e-10.
  GaussianAxis nodes;
  /// For each order k and each of `nodes.step` samples from a node on: nodes.nodes_up weights, in places
  /// t * lane + sample, lane the step rounded up to 8.
  std::vector<double> up[kOrders];
  double one = 1.0;  ///< what a sample of weight 1 adds to the moment of order 0 where it lies
};

/// nesting in samples, above 0: the cut-off of the filter, not that of the Gaussian weights, which is longer.
[[nodiscard]] RegressionAxis regressionAxis(double nesting, std::int32_t samples);

/// The Gaussian regression filter of second order: at each sample the height there of the polynomial of second degree in x and y that
/// fits the samples best, their squared distances weighted with exp(-pi (x^2 + y^2) / (alpha L)^2), alpha = 0.7309. A wave of length l
/// keeps (1 + q) exp(-q) of its amplitude, q = 1.678 (L / l)^2, half at L, in any direction. Polynomials of second degree come
/// back, ends and holes or not. (J. Seewig, Linear and robust Gaussian regression filters, 2005; S. Brinkmann and others,
/// Accessing roughness in three-dimensions using Gaussian regression filtering, 2001.)
///
/// A term that the samples of weight do not determine, because less than kLeastDetermined of it is no polynomial of the terms before it,
/// is left out, in the order 1, x, y, x^2, x y, y^2: one row has no y.
///
/// Each sum has an order of its own that neither the rectangle nor threads have an influence on.
/// Threading: prepare() from one thread; fill() afterwards from any.
class GaussianRegression {
 public:
  static constexpr double kLeastDetermined = 1e-3;
  /// No height where all weights together are less than that of one sample at the place times this.
  static constexpr double kLeastWeight = 1e-6;

  GaussianRegression(const FieldReader& field, double nesting_mm, CpuLevel level);

  /// The samples are weighted as said from now on; planes outlive every fill(). False when cancelled. Throws std::bad_alloc.
  [[nodiscard]] bool prepare(const SampleValues& samples, const JobControl& job);

  /// Heights of `rect`, row-major, signs applied, at holes too; NaN where there is none (kLeastWeight). Up to 15 elements after
  /// each row may be written. False when cancelled. Throws std::bad_alloc.
  [[nodiscard]] bool fill(const SampleRect& rect, float* out, std::ptrdiff_t stride, const JobControl& job);

 private:
  struct Scratch {
    std::vector<double> planes;  // of weights by orders 0 to 4 along x, of heights by orders 0 to 2
    std::vector<double> taps;
  };
  [[nodiscard]] bool inBlocks() const noexcept { return x_.nodes.step * y_.nodes.step < 4; }
  void heightsOf(const GaussianPlane& plane, const SampleRect& rect, float* out, std::ptrdiff_t stride);

  FieldReader reader_;
  RegressionAxis x_, y_;
  CpuLevel level_;
  GaussianPlane sums_;
  SampleValues samples_;
  tbb::enumerable_thread_specific<Scratch> scratches_;
};

}  // namespace fettle::engine
