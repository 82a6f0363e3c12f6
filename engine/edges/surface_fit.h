#pragma once

#include <array>

namespace fettle::engine {

/// Sums over samples at (d across, s along) a line with height z: what least-squares surfaces of these samples
/// need. Sums of sets of samples add and subtract. d, s in samples, z in height units above any reference.
struct Moments {
  double n = 0.0, d = 0.0, s = 0.0, dd = 0.0, ds = 0.0, ss = 0.0;
  double z = 0.0, zd = 0.0, zs = 0.0, zz = 0.0;

  void add(double at_d, double at_s, double height) noexcept {
    n += 1.0;
    d += at_d;
    s += at_s;
    dd += at_d * at_d;
    ds += at_d * at_s;
    ss += at_s * at_s;
    z += height;
    zd += height * at_d;
    zs += height * at_s;
    zz += height * height;
  }
  [[nodiscard]] Moments operator+(const Moments& o) const noexcept {
    return {n + o.n,   d + o.d, s + o.s,   dd + o.dd, ds + o.ds,
            ss + o.ss, z + o.z, zd + o.zd, zs + o.zs, zz + o.zz};
  }
  [[nodiscard]] Moments operator-(const Moments& o) const noexcept {
    return {n - o.n,   d - o.d, s - o.s,   dd - o.dd, ds - o.ds,
            ss - o.ss, z - o.z, zd - o.zd, zs - o.zs, zz - o.zz};
  }
};

/// Added to the sums of squares of coordinates, so that samples in one row or column have a plane: the one
/// that is level in the direction that they do not show. [samples^2]
inline constexpr double kLevelling = 1e-3;
/// Fewer samples than this get their mean height, a level plane.
inline constexpr double kLeastForPlane = 3.5;

/// A fitted plane z = height + slope_d (d - centre_d) + slope_s (s - centre_s).
struct PlaneFit {
  double centre_d = 0.0, centre_s = 0.0, height = 0.0, slope_d = 0.0, slope_s = 0.0;
  double residual = 0.0;  ///< sum of squares [height_unit^2]
  double count = 0.0;
  /// Inverse of the centred sums of squares: times the noise's variance, the covariance of the slopes.
  double inverse_dd = 0.0, inverse_ds = 0.0, inverse_ss = 0.0;

  [[nodiscard]] double at(double d, double s) const noexcept {
    return height + slope_d * (d - centre_d) + slope_s * (s - centre_s);
  }
  /// Variance of at(d, s) for noise of variance 1.
  [[nodiscard]] double varianceAt(double d, double s) const noexcept {
    const double u = d - centre_d, v = s - centre_s;
    return 1.0 / count + inverse_dd * u * u + 2.0 * inverse_ds * u * v + inverse_ss * v * v;
  }
  /// By how much at(d, s) rises with the height of a sample at (of_d, of_s).
  [[nodiscard]] double weightAt(double d, double s, double of_d, double of_s) const noexcept {
    const double u = d - centre_d, v = s - centre_s, x = of_d - centre_d, y = of_s - centre_s;
    return 1.0 / count + inverse_dd * u * x + inverse_ds * (u * y + v * x) + inverse_ss * v * y;
  }
  /// Variance of the residuals, three parameters taken off. [height_unit^2]
  [[nodiscard]] double variance() const noexcept { return residual / (count > 4.0 ? count - 3.0 : 1.0); }
};

/// Least-squares plane of the samples; all 0 without any.
[[nodiscard]] PlaneFit fitPlane(const Moments& m) noexcept;

/// Sum of squared residuals of the least-squares hinge: two planes that meet in the line d = `at`, the samples
/// before it in `before`, the others in `after`. [height_unit^2]
[[nodiscard]] double hingeResidual(const Moments& before, const Moments& after, double at) noexcept;

}  // namespace fettle::engine
