#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Dense>

#include "engine/base/job.h"
#include "engine/measure/fit_samples.h"
#include "engine/measure/fit_surface.h"

namespace fettle::engine {

/// Numbers by which a surface of a kind is moved, from a base: the foot along the base's normal; turns about the foot [rad];
/// then ring (of a sphere with tube), theta, tube. Lengths in parts of a scale.
struct FitModel {
  static constexpr int kMost = 7;

  ShapeKind kind = ShapeKind::kPlane;
  FitSurface base;

  [[nodiscard]] int size() const noexcept { return infoOf(kind).numbers; }
  [[nodiscard]] FitSurface moved(const Eigen::VectorXd& by) const noexcept;

  /// How the distance at a point follows the numbers, for a surface moved by `by`.
  class Rows {
   public:
    Rows(const FitModel& model, const Eigen::VectorXd& by);
    [[nodiscard]] const FitSurface& surface() const noexcept { return surface_; }
    /// size() derivatives to `out`.
    void derivatives(const FitSurface::At& at, const glm::dvec3& point, double* out) const noexcept;

   private:
    ShapeKind kind_;
    FitSurface surface_;
    glm::dvec3 normal_;
    glm::dvec3 turns_[3];  // what a small change of each turn turns about, at `by`
  };
  /// What a number moves, as a word: "position", "direction", "radius", "angle", "tube".
  [[nodiscard]] const char* nameOf(int number) const noexcept;
};

/// How distances count.
struct FitWeights {
  bool vertical = false;
  double robust_scale = 0.0;  ///< [scale]; 0: all count fully

  static constexpr double kTukey = 4.685;
  static constexpr double kSteepest = 0.1;  ///< least cosine of an inclination

  /// The factor of a distance at a surface whose gradient rises by `gradient_z`.
  [[nodiscard]] double factor(double gradient_z) const noexcept;
  /// Whether a residual counts at all, and its share of 1: (1 - x^2)^2.
  [[nodiscard]] double share(double residual) const noexcept;
};

/// Where a sample counts on a surface: nearest to it, or with vertical distances above or below it.
struct FitPlace {
  FitSurface::At at;
  glm::dvec3 point{
      0.0};  ///< at which the derivatives of the distance are those of the residual, times `factor`
  double factor = 1.0;
  double residual = 0.0;
};
/// The place for a point. Vertical: by Newton's steps along z, exact; where none is found on which the surface is flatter than 84
/// degrees, the distance over the cosine of that inclination.
[[nodiscard]] FitPlace placeOf(const FitSurface& surface, const FitWeights& weights,
                               const glm::dvec3& p) noexcept;

/// Points in parts of `scale`.
struct FitPoints {
  const FitSamples* samples = nullptr;
  double scale = 1.0;
  /// Groups of blocks that one worker takes in turn; not by the number of threads.
  [[nodiscard]] std::size_t groups() const noexcept;
  [[nodiscard]] std::size_t begin(std::size_t group) const noexcept;
};

/// The surface of the model at which the sum of squares, or of Tukey's function, of weighted distances is least, near the
/// base. False where no finite one was found. Throws std::bad_alloc.
[[nodiscard]] bool solveFit(const FitPoints& points, const FitWeights& weights, FitModel& model,
                            JobControl& job);

/// Weighted distances of all points from a surface.
[[nodiscard]] std::vector<float> residualsOf(const FitPoints& points, const FitWeights& weights,
                                             const FitSurface& surface);

}  // namespace fettle::engine
