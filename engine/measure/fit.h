#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/measure/fit_samples.h"
#include "engine/measure/fit_shape.h"
#include "engine/measure/fit_surface.h"
#include "engine/measure/section_figures.h"

namespace fettle::engine {

struct FitOptions {
  /// What is made small: the squares of orthogonal distances, as ISO 10360-6 and the Gaussian association of ISO 14405-1
  /// have it; or of heights, distances over the cosine of the inclination, which noise in height asks for. Steeper than
  /// 84 degrees both count as there.
  bool vertical = false;
  /// Samples far from the shape do not count: Tukey's biweight at 4.685 times the normalised median distance. Half of the
  /// samples must be nearer than the others are.
  bool robust = false;
  /// Noise of a sample's height, a standard deviation [mm]; NaN: not known.
  double noise_mm = 0.0;
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
  /// By how much the variance of the stated errors exceeds that of noise that is independent from sample to sample.
  double correlation = 1.0;

  // What the errors of figures are computed from: the numbers that were fitted, in parts of `scale` from `middle`, and
  // their covariance.
  FitSurface surface;
  double scale = 1.0;
  int numbers = 0;
  std::array<double, kMost * kMost> covariance{};

  /// The shape with the numbers moved by `by`.
  [[nodiscard]] Shape moved(const std::array<double, kMost>& by) const noexcept;
  /// Standard errors of the shape's figures: of point and direction by component.
  struct Errors {
    glm::dvec3 point{0.0}, direction{0.0};
    double radius = 0.0, tube_radius = 0.0, half_angle = 0.0;
  };
  [[nodiscard]] Errors errors() const noexcept;
};

/// Fits one kind of shape to the samples by Levenberg and Marquardt (Eigen's port of MINPACK) from start values by normals.
///
/// Errors of the figures: those that noise in height of independent samples gives, of the size `noise_mm`, or of what is
/// left where that is more by three standard errors of it; and more where sums over parts of the region scatter by more,
/// as noise does that neighbours share. Not counted: noise or deviations of form as long as the region.
///
/// What the samples do not determine is refused (kInput): fewer samples than numbers; a radius, an apex or a ring that does
/// not differ by three standard errors from a plane, a cylinder, a sphere; a direction that is known to 10 degrees or worse.
/// Accuracy: sums of squares by orthogonal triangles (Householder) of parts in double. Bit-identical for any number of
/// threads. Cost: some 5 to 40 passes over the samples. Errors: kInput, kCancelled. Throws std::bad_alloc. Thread: any; a
/// long job on all workers of the calling arena.
[[nodiscard]] Result<ShapeFit> fitShape(const FitSamples& samples, ShapeKind kind, const FitOptions& options,
                                        JobControl& job);

/// The distance of a point [mm, field coordinates] from a fit, above 0 above it; along z to first order with `vertical`.
[[nodiscard]] double residualAt(const ShapeFit& fit, const glm::dvec3& point, bool vertical) noexcept;

/// A shape that was tried, or why not.
struct TriedShape {
  ShapeKind kind = ShapeKind::kPlane;
  double rms_mm = 0.0;  ///< NaN: refused
  std::string refused;
};
struct ChosenShape {
  ShapeFit fit;
  std::vector<TriedShape> tried;
};
/// The shape, of some kinds, that describes the samples best. A shape is taken in place of a simpler one that it contains
/// (plane, then sphere or cylinder, cylinder, then cone, cone or sphere, then torus) only where it lowers the rms by a tenth,
/// and of those that are left the one with the least Bayesian information (G. Schwarz, Estimating the dimension of a model,
/// 1978), the samples counted as ShapeFit::correlation says. Chosen by at most some 260,000 of the samples, fitted to all.
[[nodiscard]] Result<ChosenShape> fitBestShape(const Version& field, const FitRegion& region,
                                               const std::vector<ShapeKind>& kinds, const FitOptions& options,
                                               JobControl& job);

/// What lies between two fits of different samples.
struct ShapeRelation {
  /// Between normals, axes, or a normal and an axis as the angle between plane and axis [degrees], 0 to 90; NaN without
  /// two directions.
  Estimate angle_deg;
  /// Plane and another: of the other's point from the plane, above 0 above it; of two planes that of the middle of the
  /// second's samples from the first. Axis and another: from the other's point, of a second axis that nearest to the middle
  /// of its samples, to the first axis. Spheres, torus centres: between the points [mm].
  Estimate distance_mm;
  /// Two axes: the shortest distance between the lines; NaN else, and for parallel ones (angle below three errors).
  Estimate between_axes_mm;
};
[[nodiscard]] ShapeRelation relationOf(const ShapeFit& first, const ShapeFit& second) noexcept;

}  // namespace fettle::engine
