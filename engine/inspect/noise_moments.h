#pragma once

#include <array>
#include <cstdint>

namespace fettle::engine {

// The second moments of what a smooth surface leaves in a window of a scan; noise_parts.h has the noise that explains them.
//
// A window of kNoiseSide x kNoiseSide heights is fitted with polynomials of degree 2 in its columns times degree 2 in
// its rows, 9 in all. What remains, r, is less than the noise, and along a row or a column more uncorrelated: the fit
// took its share.

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

}  // namespace fettle::engine
