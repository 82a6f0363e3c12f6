#pragma once

#include <cstdint>
#include <vector>

#include "engine/measure/spatial.h"

namespace fettle::engine {

/// Direction of the profiles that a spectrum is of.
enum class ProfileAxis : std::uint8_t { kX, kY };

/// Power spectral density of the profiles of a surface along an axis, one-sided: the mean square of what has a frequency
/// from f to f + df is density(f) df.
struct ProfileSpectrum {
  double step = 0.0;  ///< between frequencies [1/mm]
  std::vector<double>
      density;  ///< at 0, step, 2 step .. half the frequency of the samples; empty where there is none

  [[nodiscard]] double frequency(std::size_t i) const noexcept { return static_cast<double>(i) * step; }
};

/// Estimates it from the autocorrelation along the axis, tapered by von Hann's window up to the largest lag, or to the one
/// before the first that has no value (R. Blackman, J. Tukey, The measurement of power spectra, 1958): a mean over all
/// profiles, holes left out, in which a sharp line is as wide as two steps. Where there is little power a density may be
/// below 0, by a hundredth of a neighbouring line's. The sum of all densities, those at both ends by half, times the step is
/// `mean_square`, in the square of whose unit times mm densities are.
///
/// Time: the square of the number of lags. Thread: any. May throw std::bad_alloc.
[[nodiscard]] ProfileSpectrum profileSpectrum(const Autocorrelation& correlation, ProfileAxis axis,
                                              double mean_square);

}  // namespace fettle::engine
