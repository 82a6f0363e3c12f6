#include "engine/measure/profile_spectrum.h"

#include <cmath>
#include <cstddef>
#include <numbers>

namespace fettle::engine {

ProfileSpectrum profileSpectrum(const Autocorrelation& correlation, ProfileAxis axis, double mean_square) {
  const bool along_x = axis == ProfileAxis::kX;
  const std::int32_t most = along_x ? correlation.lags_x : correlation.lags_y;
  const double spacing = along_x ? correlation.spacing_x : correlation.spacing_y;
  ProfileSpectrum spectrum;
  if (correlation.values.empty()) return spectrum;
  std::vector<double> lags;  // 0, 1, ...
  for (std::int32_t lag = 0; lag <= most; ++lag) {
    const double value = along_x ? correlation.at(lag, 0) : correlation.at(0, lag);
    if (std::isnan(value)) break;
    lags.push_back(value);
  }
  const std::size_t count = lags.size();
  if (count < 2) return spectrum;
  for (std::size_t i = 0; i < count; ++i)
    lags[i] *= 0.5 + 0.5 * std::cos(std::numbers::pi * static_cast<double>(i) / static_cast<double>(count));

  spectrum.step = 0.5 / (static_cast<double>(count) * spacing);
  spectrum.density.reserve(count + 1);
  for (std::size_t k = 0; k <= count; ++k) {
    // sum of lags[i] cos(i angle), i >= 1: C. W. Clenshaw, A note on the summation of Chebyshev series, 1955.
    const double cosine = std::cos(std::numbers::pi * static_cast<double>(k) / static_cast<double>(count));
    double next = 0.0, after = 0.0;
    for (std::size_t i = count - 1; i >= 1; --i) {
      const double here = lags[i] + 2.0 * cosine * next - after;
      after = next;
      next = here;
    }
    spectrum.density.push_back(2.0 * spacing * mean_square * (lags[0] + 2.0 * (cosine * next - after)));
  }
  return spectrum;
}

}  // namespace fettle::engine
