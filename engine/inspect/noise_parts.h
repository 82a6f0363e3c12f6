#pragma once

#include <array>
#include <cstdint>

#include "engine/inspect/noise_moments.h"

namespace fettle::engine {

// The noise that explains the moments of noise_moments.h. With Q the projection on the polynomials of the fit and C the
// covariance of the noise, r has the covariance (1 - Q) C (1 - Q). C is taken as a sum of parts of known form, so that the
// expected moments of r are linear in the sizes of the parts, and the sizes are solved for.

/// The size of each part of the noise, as a variance or covariance in the unit of the moments.
struct NoiseParts {
  double uncorrelated = 0.0;  ///< and what correlated noise has at lag 0
  /// Covariance of samples 1, 2 .. apart, without that of the offsets; 0 from the first that cannot be told from 0.
  std::array<double, kNoiseLags> along_row{}, along_column{};
  double row_offset = 0.0;     ///< variance of what a whole row is off, >= 0
  double column_offset = 0.0;  ///< of what a whole column is off, >= 0

  /// Of a sample.
  [[nodiscard]] double variance() const noexcept { return uncorrelated + row_offset + column_offset; }
  /// Multiplies all by `factor`.
  void scale(double factor) noexcept;
};

/// The noise behind the mean moments of `windows` windows.
///
/// Its variance is that of the finest detail along rows or along columns, whichever is larger: noise is what a sample
/// has and the next one has not, in one direction at least. Noise of scanners that work by lines has nothing in common
/// from row to row; a rough surface has in both directions (in geostatistics: the nugget, G. Matheron 1963). What is
/// correlated along the other direction as well is therefore the surface's. What samples of a line share is as much
/// as is missing from the finest detail along the line against that across it, where a surface has nearly none in either:
/// one that is rougher in one direction is not taken for noise of lines, and hides none. Parts that are less than three standard
/// errors from 0 are 0. Any thread; allocates nothing.
[[nodiscard]] NoiseParts noiseOf(const NoiseMoments& mean, std::int64_t windows) noexcept;

}  // namespace fettle::engine
