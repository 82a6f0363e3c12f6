#include "engine/suggest/noise_source.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <tbb/parallel_for.h>

#include "engine/scanner/counter_random.h"

namespace fettle::engine {

namespace {

// Weights that give uncorrelated noise of variance 1 the covariances 1, lags[0] / own, ..: the inverse transform of
// the root of their spectrum. Where the lags are no covariance of anything their spectrum is negative, and 0 here.
std::vector<double> weightsFor(const std::array<double, kNoiseLags>& lags, double own) {
  constexpr int kFrequencies = 64, kReach = 2 * kNoiseLags;
  if (lags[0] == 0.0 || !(own > 0.0)) return {1.0};
  std::array<double, kFrequencies> root;
  for (int f = 0; f < kFrequencies; ++f) {
    double power = 1.0;
    for (int k = 0; k < kNoiseLags; ++k)
      power += 2.0 * lags[static_cast<std::size_t>(k)] / own *
               std::cos(2.0 * std::numbers::pi * f * (k + 1) / kFrequencies);
    root[static_cast<std::size_t>(f)] = std::sqrt(std::max(power, 0.0));
  }
  std::vector<double> weights;
  double squares = 0.0;
  for (int j = -kReach; j <= kReach; ++j) {
    double sum = 0.0;
    for (int f = 0; f < kFrequencies; ++f)
      sum += root[static_cast<std::size_t>(f)] * std::cos(2.0 * std::numbers::pi * f * j / kFrequencies);
    weights.push_back(sum / kFrequencies);
    squares += weights.back() * weights.back();
  }
  for (double& w : weights) w /= std::sqrt(squares);
  return weights;
}

}  // namespace

NoiseSource::NoiseSource(const NoiseParts& parts)
    : own_(std::sqrt(std::max(parts.uncorrelated, 0.0))),
      row_offset_(std::sqrt(std::max(parts.row_offset, 0.0))),
      column_offset_(std::sqrt(std::max(parts.column_offset, 0.0))),
      along_row_(weightsFor(parts.along_row, parts.uncorrelated)),
      along_column_(weightsFor(parts.along_column, parts.uncorrelated)) {}

std::vector<double> NoiseSource::make(std::int32_t columns, std::int32_t rows, std::uint64_t seed) const {
  const CounterRandom own(seed, 0), of_row(seed, 1), of_column(seed, 2);
  const auto across = static_cast<std::int32_t>(along_row_.size() / 2);
  const auto up = static_cast<std::int32_t>(along_column_.size() / 2);
  const std::int32_t wide = columns + 2 * across, high = rows + 2 * up;
  std::vector<double> by_row(static_cast<std::size_t>(columns) * static_cast<std::size_t>(high));
  tbb::parallel_for(std::int32_t{0}, high, [&](std::int32_t r) {
    std::vector<double> white(static_cast<std::size_t>(wide));
    for (std::int32_t c = 0; c < wide; ++c) white[static_cast<std::size_t>(c)] = own.normal(c, r);
    double* out = by_row.data() + static_cast<std::ptrdiff_t>(r) * columns;
    for (std::size_t k = 0; k < along_row_.size(); ++k)
      for (std::int32_t c = 0; c < columns; ++c)
        out[c] += along_row_[k] * white[static_cast<std::size_t>(c) + k];
  });
  std::vector<double> noise(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  std::vector<double> column_offset(static_cast<std::size_t>(columns));
  for (std::int32_t c = 0; c < columns; ++c)
    column_offset[static_cast<std::size_t>(c)] = column_offset_ * of_column.normal(c, 0);
  tbb::parallel_for(std::int32_t{0}, rows, [&](std::int32_t r) {
    double* out = noise.data() + static_cast<std::ptrdiff_t>(r) * columns;
    // Row by row, so that a cache line is read once.
    const double* from = by_row.data() + static_cast<std::ptrdiff_t>(r) * columns;
    for (const double weight : along_column_) {
      for (std::int32_t c = 0; c < columns; ++c) out[c] += weight * from[c];
      from += columns;
    }
    const double offset = row_offset_ * of_row.normal(0, r);
    for (std::int32_t c = 0; c < columns; ++c)
      out[c] = own_ * out[c] + offset + column_offset[static_cast<std::size_t>(c)];
  });
  return noise;
}

}  // namespace fettle::engine
