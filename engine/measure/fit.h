#pragma once

#include <array>
#include <cstdint>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/measure/fit_samples.h"
#include "engine/measure/fit_shape.h"
#include "engine/measure/fit_surface.h"

namespace fettle::engine {

struct FitOptions {
  /// What is made small: the squares of orthogonal distances, as ISO 10360-6 and the Gaussian association of ISO 14405-1
  /// have it; or of distances along z, which noise in height asks for. Where the surface is steeper than 84 degrees, or has no place
  /// above or below a sample, the distance over the cosine of that inclination stands for that along z.
  bool vertical = false;
  /// Samples far from the shape do not count: Tukey's biweight at 4.685 times the normalised median distance. Half of the
  /// samples must be nearer than the others are.
  bool robust = false;
  /// Noise of a sample's height, a standard deviation [mm]; NaN: not known.
  double noise_mm = 0.0;
  /// Besides, what a whole row of samples is off, and a whole column, standard deviations [mm].
  double rows_mm = 0.0, columns_mm = 0.0;
  /// Variance of means of many neighbours over that of independent noise, at least 1: what samples of a line have in common
  /// over a few of them.
  double shared = 1.0;
};

/// A fitted shape, in field coordinates [mm].
struct ShapeFit {
  static constexpr int kMost = 7;

  Shape shape;
  glm::dvec3 middle{0.0};     ///< of the samples
  std::int64_t samples = 0;   ///< of the region
  std::int64_t left_out = 0;  ///< with `robust`: those that do not count
  double rms_mm = 0.0;        ///< of the distances of those that count, as they were made small
  double largest_mm = 0.0;    ///< distance of a sample that counts, its size
  /// The variance of the stated errors over that by noise of the same size that is independent from sample to sample: the
  /// mean over the numbers, of which noise of rows or columns makes some more uncertain and others less.
  double correlation = 1.0;

  // What the errors of figures are computed from: the numbers that were fitted, in parts of `scale` from `middle`, and
  // their covariance.
  FitSurface surface;
  double scale = 1.0;
  int numbers = 0;
  std::array<double, kMost * kMost> covariance{};
  /// What noise moves them by on average (fit_bias.h); the numbers are as they were fitted.
  std::array<double, kMost> bias{};

  /// The shape with the numbers moved by `by`.
  [[nodiscard]] Shape moved(const std::array<double, kMost>& by) const noexcept;
  /// Standard errors of the shape's figures: of point and direction by component.
  struct Errors {
    glm::dvec3 point{0.0}, direction{0.0};
    double radius = 0.0, tube_radius = 0.0, half_angle = 0.0;
    double tilt_x = 0.0,
           tilt_y = 0.0;  ///< of a plane: of the angles at which it rises along x and y [radians]
  };
  [[nodiscard]] Errors errors() const noexcept;
  /// What noise in height moves the same figures by on average, to second order: in no error, and not taken off them.
  [[nodiscard]] Errors biases() const;
};

/// Fits one kind of shape to the samples by Levenberg and Marquardt (Eigen's port of MINPACK) from start values by normals.
///
/// Errors of the figures: those that noise in height gives, (J^T J)^-1 J^T C J (J^T J)^-1 with the derivatives J of distances and
/// the covariance C of the noise: of independent samples, of the size `noise_mm`, or of what is left where that is more by three
/// standard errors of it, and of whole rows and columns; NaN where the noise is not known and the samples are no more than the
/// numbers; and more where sums over parts of the region scatter by more than this noise makes them, as noise does that
/// neighbours share in both directions. Not counted: noise or deviations of form as long as the region.
///
/// What the samples do not determine is refused (kInput): fewer samples than numbers; a radius, an apex or a ring that does
/// not differ by three standard errors from a plane, a cylinder, a sphere; a direction that is known to 10 degrees or worse.
/// Accuracy: sums of squares by orthogonal triangles (Householder) of parts in double. Bit-identical for any number of
/// threads. Cost: some 5 to 40 passes over the samples. Errors: kInput, kCancelled. Throws std::bad_alloc. Thread: any; a
/// long job on all workers of the calling arena.
[[nodiscard]] Result<ShapeFit> fitShape(const FitSamples& samples, ShapeKind kind, const FitOptions& options,
                                        JobControl& job);

/// The distance of a point [mm, field coordinates] from a fit, above 0 above it; along z with `vertical`.
[[nodiscard]] double residualAt(const ShapeFit& fit, const glm::dvec3& point, bool vertical) noexcept;

}  // namespace fettle::engine
