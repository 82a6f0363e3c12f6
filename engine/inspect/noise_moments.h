#pragma once

#include <array>
#include <cstdint>

namespace fettle::engine {

// The second moments of what a smooth surface leaves in a window of a scan, and the noise that explains them.
//
// A window of kNoiseSide x kNoiseSide heights is fitted with polynomials of degree 2 in its columns times degree 2 in
// its rows, 9 in all. What remains, r, is less than the noise, and along a row or a column more uncorrelated: the fit
// took its share. With Q the projection on the polynomials and C the covariance of the noise, r has the covariance
// (1 - Q) C (1 - Q). C is taken as a sum of parts of known form, so that the expected moments of r are linear in the
// sizes of the parts, and the sizes are solved for.

inline constexpr int kNoiseSide = 16;  ///< of a window [samples]
inline constexpr int kNoiseLags = 6;   ///< correlation is seen to this distance [samples]

/// Mean products of r in a window, in any unit squared. All 0 in a new one.
struct NoiseMoments {
  double square = 0.0;                            ///< r^2
  std::array<double, kNoiseLags> along_row{};     ///< products of samples 1, 2 .. apart in a row
  std::array<double, kNoiseLags> along_column{};  ///< in a column
  double row_sum = 0.0;  ///< squared sum of a row over kNoiseSide: the square, if rows had nothing in common
  double column_sum = 0.0;  ///< of a column
  /// Fourth differences along rows and along columns, squared, over 70: the square, if samples had nothing in common.
  double row_detail = 0.0, column_detail = 0.0;

  /// The larger of both.
  [[nodiscard]] double detail() const noexcept {
    return row_detail > column_detail ? row_detail : column_detail;
  }
  /// Adds `weight` times other moments.
  void add(const NoiseMoments& other, double weight) noexcept;
};

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

/// What is left of a window.
struct NoiseWindow {
  NoiseMoments moments;
  int known = 0;  ///< samples used; more than 5 standard deviations of the others off are none
  /// What a surface that the fit does not follow, an edge first of all, raises, over the square of the finest detail:
  /// mean squares of the polynomials of degree 3 to 5 along rows alone (kNoiseGroupSizes of them), along columns alone,
  /// of both; and of everything. In noise alone each is about the same in all windows, whatever its correlation.
  std::array<double, 4> surface{};
  /// Variance of the noise by the finest detail in both directions alone, as if it were uncorrelated. Edges raise it
  /// hardly, noise that neighbours share lowers it.
  double finest = 0.0;

  /// Whether enough samples were there: 15 of 16.
  [[nodiscard]] bool usable() const noexcept { return known >= kNoiseSide * kNoiseSide * 15 / 16; }
};

inline constexpr std::array<int, 3> kNoiseGroupSizes{3, 3, 21};

/// Fits and removes the surface of a window, kNoiseSide rows of kNoiseSide heights in one unit, NaN where there is none.
/// Missing samples and spikes are replaced by the fit, a few times over. Turning the heights upside down changes
/// nothing. Any thread; allocates nothing.
[[nodiscard]] NoiseWindow noiseWindow(const std::array<float, kNoiseSide * kNoiseSide>& heights) noexcept;

/// The noise behind the mean moments of `windows` windows.
///
/// Its variance is that of the finest detail along rows or along columns, whichever is larger: noise is what a sample
/// has and the next one has not, in one direction at least. Noise of scanners that work by lines has nothing in common
/// from row to row; a rough surface has in both directions (in geostatistics: the nugget, G. Matheron 1963). What is
/// correlated along the other direction as well is therefore the surface's. Parts that are less than three standard
/// errors from 0 are 0. Any thread; allocates nothing.
[[nodiscard]] NoiseParts noiseOf(const NoiseMoments& mean, std::int64_t windows) noexcept;

}  // namespace fettle::engine
