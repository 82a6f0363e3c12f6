#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/measure/surface.h"

namespace fettle::engine {

/// The autocorrelation of a surface (ISO 25178-2:2021, 3.2): the mean of z(x, y) z(x + tx, y + ty) over the samples that
/// both surfaces have, over the mean of z^2. 1 without a lag; the same for (tx, ty) and (-tx, -ty).
struct Autocorrelation {
  std::int32_t lags_x = 0, lags_y = 0;      ///< largest, half of the surface's sides [samples]
  double spacing_x = 1.0, spacing_y = 1.0;  ///< [mm]
  /// Of lags -lags_x .. lags_x along x for each of 0 .. lags_y along y. NaN where both have fewer samples than a
  /// sixteenth of the surface's.
  std::vector<double> values;

  [[nodiscard]] std::size_t columns() const noexcept { return 2 * static_cast<std::size_t>(lags_x) + 1; }
  /// |tx| <= lags_x, |ty| <= lags_y.
  [[nodiscard]] double at(std::int32_t tx, std::int32_t ty) const noexcept {
    if (ty < 0) tx = -tx, ty = -ty;
    return values[static_cast<std::size_t>(ty) * columns() + static_cast<std::size_t>(tx + lags_x)];
  }
  /// Between lags, bilinear; a distance in millimetres. NaN beyond the largest lags and beside a NaN.
  [[nodiscard]] double valueAt(double x_mm, double y_mm) const noexcept;
  /// Where it first falls to `level` along a ray at `angle` [radians, from x to y], as a distance [mm]: between lags the
  /// function is bilinear. Infinity if it does not before the largest lag or a NaN.
  [[nodiscard]] double decay(double angle, double level) const noexcept;
};

/// The power of a surface over directions: its angular spectrum (ISO 25178-2:2021, 3.2).
struct AngularSpectrum {
  static constexpr int kBins = 360;  ///< over half a turn
  /// Over the frequencies of a direction of the wave vector, the integral of power times frequency; bin i at i / 2 degrees
  /// from x to y; their sum is 1.
  std::vector<double> power;
  /// The same of heights of the same mean square that no two samples share, as white noise: next to equal in all directions.
  std::vector<double> white;
};

/// Spatial parameters: ISO 25178-2:2021, 4.3, and the texture direction.
struct SpatialParameters {
  double sal = 0.0;  ///< autocorrelation length: the shortest distance in which it falls to 0.2 [mm]
  double str = 0.0;  ///< texture aspect ratio: sal over the longest such distance, 0 .. 1
  double sal_direction = 0.0;   ///< of the fastest decay [degrees from x to y, 0 <= . < 180]
  double slow_direction = 0.0;  ///< of the slowest
  /// Std, texture direction: that of the lay, across which the angular spectrum has its largest peak (the mean of what is
  /// above half of it) [degrees from x to y, 0 <= . < 180). 0 and 180 are one direction: a lay along x is at 0.1 or, 0.2 degrees from it, at 179.9.
  /// As the standard's angle of the spectrum's maximum itself with the y axis as the reference direction.
  double lay = 0.0;
  /// Ssw, dominant spatial wavelength: of the largest absolute value of the Fourier transform of the heights (holes are at the mean), there of the
  /// wave that leaves least of them, nearestWave(); no longer than the surface [mm].
  double ssw = 0.0;
  /// Why a figure is NaN; empty where it is none.
  std::string no_sal, no_str, no_lay, no_ssw;
  /// Str over itself were the level of decay lower by these shares of it, to 2 %; NaN where it would be none. Noise that neighbours do not share
  /// and that makes a share of the mean square lowers the autocorrelation by this share at every lag but 0, so that without noise Str
  /// is that at a lower level. A jump between two of them is another direction, or another wave, that decays last.
  static constexpr std::array<double, 8> kLowered{0.002, 0.005, 0.01, 0.02, 0.04, 0.08, 0.16, 0.32};
  std::array<double, kLowered.size()> str_lowered{};
  /// Str were noise a share of the mean square, between these; that of the highest beyond it.
  [[nodiscard]] double strWithout(double share) const noexcept;
  /// Std were k / kLayParts of the mean square noise that neighbours do not share: of the angular spectrum less what that has in each direction. NaN
  /// where nothing is left. A jump from one to the next is another peak, or another one beside it that counts with it, as long as noise lifts both.
  static constexpr int kLayParts = 32;
  std::array<double, kLayParts> lay_less{};
  /// That of any share below 1, between these.
  [[nodiscard]] double layWithout(double share) const noexcept;
};

struct SpatialAnalysis {
  SpatialParameters parameters;
  Autocorrelation correlation;
  AngularSpectrum spectrum;
};

/// Bytes that correlate() takes beside the surface.
[[nodiscard]] double correlationBytes(const Surface& surface) noexcept;

/// Correlates a surface with itself and finds its spatial parameters. Holes and samples outside the region take no
/// part: neither in products nor in their number. The angular spectrum is the transform of the correlation up to the
/// largest lags, tapered by von Hann's window, from 1.5 waves over the surface to the lower of the two Nyquist
/// frequencies, so that no direction has more frequencies than others (R. Blackman, J. Tukey, The measurement of power
/// spectra, 1958).
///
/// In double; bit-identical for any number of threads. Memory: some 36 bytes per sample. Errors: kCancelled. Throws
/// std::bad_alloc. Thread: any; a long job on all workers of the calling arena.
[[nodiscard]] Result<SpatialAnalysis> correlate(const Surface& surface, JobControl& job);

}  // namespace fettle::engine
