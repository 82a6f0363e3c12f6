#include "engine/inspect/noise_parts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "engine/inspect/noise_polynomials.h"

namespace fettle::engine {

namespace {

// A moment, or a part of the noise, is a form along rows times one along columns. Forms: 0 the same sample, 1 ..
// kNoiseLags that many apart, then all.
constexpr std::size_t kForms = kNoiseLags + 2, kAll = kNoiseLags + 1;
struct Pair {
  std::size_t across, up;
};
// The sample itself; rows' lags; columns' lags; whole rows; whole columns.
constexpr std::size_t kParts = 2 * kNoiseLags + 3;
constexpr std::size_t kRowLags = 1, kColumnLags = 1 + kNoiseLags, kRows = 1 + 2 * kNoiseLags,
                      kColumns = kRows + 1;

constexpr Pair partOf(std::size_t i) noexcept {
  if (i == 0) return {0, 0};
  if (i < kColumnLags) return {i, 0};
  if (i < kRows) return {0, i - kNoiseLags};
  return i == kRows ? Pair{kAll, 0} : Pair{0, kAll};
}

using Matrix = std::array<std::array<double, kNoiseSide>, kNoiseSide>;

Matrix formOf(std::size_t form) noexcept {
  Matrix m{};
  for (std::size_t i = 0; i < kNoiseSide; ++i)
    for (std::size_t j = 0; j < kNoiseSide; ++j)
      m[i][j] = form == kAll || (i > j ? i - j : j - i) == form ? 1.0 : 0.0;
  return m;
}

Matrix times(const Matrix& a, const Matrix& b) noexcept {
  Matrix m{};
  for (std::size_t i = 0; i < kNoiseSide; ++i)
    for (std::size_t k = 0; k < kNoiseSide; ++k)
      for (std::size_t j = 0; j < kNoiseSide; ++j) m[i][j] += a[i][k] * b[k][j];
  return m;
}

// Mean of b's elements where `a` is 1; of all over the side, as sums are.
double meanWhere(const Matrix& a, const Matrix& b, std::size_t form) noexcept {
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < kNoiseSide; ++i)
    for (std::size_t j = 0; j < kNoiseSide; ++j) sum += a[i][j] * b[i][j], count += a[i][j];
  return sum / (form == kAll ? static_cast<double>(kNoiseSide) : count);
}

// expected[m][p]: moment m of what the fit leaves of part p with size 1. For a part A x B (along rows, along
// columns) and the projections P of either direction, (1 - P x P)(A x B)(1 - P x P) is A x B less PA x PB less its
// transpose plus PAP x PBP.
using Table = std::array<std::array<double, kParts>, kParts>;

Table makeExpected() noexcept {
  const NoisePolynomials& p = noisePolynomials();
  Matrix projection{};
  for (std::size_t d = 0; d < kNoiseDegrees; ++d)
    for (std::size_t i = 0; i < kNoiseSide; ++i)
      for (std::size_t j = 0; j < kNoiseSide; ++j) projection[i][j] += p[d][i] * p[d][j];
  struct Means {
    double whole, once, twice;  // A, PA, PAP
  };
  std::array<std::array<Means, kForms>, kForms> means;  // [form of the moment][form of the part]
  for (std::size_t part = 0; part < kForms; ++part) {
    const Matrix whole = formOf(part), once = times(projection, whole), twice = times(once, projection);
    for (std::size_t moment = 0; moment < kForms; ++moment) {
      const Matrix where = formOf(moment);
      means[moment][part] = {meanWhere(where, whole, moment), meanWhere(where, once, moment),
                             meanWhere(where, twice, moment)};
    }
  }
  Table table;
  for (std::size_t m = 0; m < kParts; ++m)
    for (std::size_t q = 0; q < kParts; ++q) {
      const Means& across = means[partOf(m).across][partOf(q).across];
      const Means& up = means[partOf(m).up][partOf(q).up];
      table[m][q] = across.whole * up.whole - 2.0 * across.once * up.once + across.twice * up.twice;
    }
  return table;
}

const Table& expected() noexcept {
  static const Table made = makeExpected();
  return made;
}

using Sizes = std::array<double, kParts>;
using Chosen = std::array<bool, kParts>;

// The sizes of the chosen parts that explain the same moments; 0 for the others. Gaussian elimination with pivoting.
Sizes solve(const Sizes& moments, const Chosen& chosen) noexcept {
  std::array<std::size_t, kParts> of{};
  std::size_t n = 0;
  for (std::size_t i = 0; i < kParts; ++i)
    if (chosen[i]) of[n++] = i;
  std::array<std::array<double, kParts + 1>, kParts> a{};
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) a[i][j] = expected()[of[i]][of[j]];
    a[i][n] = moments[of[i]];
  }
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t most = k;
    for (std::size_t i = k + 1; i < n; ++i)
      if (std::abs(a[i][k]) > std::abs(a[most][k])) most = i;
    std::swap(a[k], a[most]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = a[i][k] / a[k][k];
      for (std::size_t j = k; j <= n; ++j) a[i][j] -= factor * a[k][j];
    }
  }
  Sizes sizes{};
  for (std::size_t k = n; k-- > 0;) {
    double left = a[k][n];
    for (std::size_t j = k + 1; j < n; ++j) left -= a[k][j] * sizes[of[j]];
    sizes[of[k]] = left / a[k][k];
  }
  return sizes;
}

// What samples of a line share is missing from their squared fourth differences over 70: offsets wholly, covariances of
// samples 1 .. 4 apart by these weights.
constexpr std::array<double, 4> kMissing{112.0 / 70.0, -56.0 / 70.0, 16.0 / 70.0, -2.0 / 70.0};

double missingOf(double offset, const std::array<double, kNoiseLags>& along) noexcept {
  double missing = offset;
  for (std::size_t k = 0; k < kMissing.size(); ++k) missing += kMissing[k] * along[k];
  return missing;
}

// Makes what samples of a line are found to share as much as is missing from the finest detail along it, known to `error`. A
// surface that is rougher in one direction has the same long moments as noise of lines, or hides them, but has no finest
// detail. Where both disagree the moments are the surface's for the most part, and of the covariance of the noise is known
// no more than that it is not negative and does not rise with distance, as of noise that was smoothed; if nothing is left of
// it, offsets scatter figures most.
void agreeWithMissing(double& offset, std::array<double, kNoiseLags>& along, double variance, double missing,
                      double error) noexcept {
  if (!(std::abs(missingOf(offset, along) - missing) > 3.0 * error)) return;
  double most = std::max(along[0], 0.0);
  for (double& covariance : along) covariance = most = std::clamp(covariance, 0.0, most);
  const double found = missingOf(offset, along);
  if (found <= 0.0) {
    offset = missing;
    return;
  }
  offset = std::min(offset * (missing / found), variance);
  for (double& covariance : along) covariance = std::min(covariance * (missing / found), variance - offset);
}

}  // namespace

void NoiseParts::scale(double factor) noexcept {
  uncorrelated *= factor;
  row_offset *= factor;
  column_offset *= factor;
  for (double& part : along_row) part *= factor;
  for (double& part : along_column) part *= factor;
}

NoiseParts noiseOf(const NoiseMoments& mean, std::int64_t windows) noexcept {
  Sizes moments{};
  moments[0] = mean.square;
  for (std::size_t k = 0; k < kNoiseLags; ++k) {
    moments[kRowLags + k] = mean.along_row[k];
    moments[kColumnLags + k] = mean.along_column[k];
  }
  moments[kRows] = mean.row_sum;
  moments[kColumns] = mean.column_sum;
  // Standard errors in white noise: of a product 1 / sqrt(samples), of a squared sum sqrt(2 / rows), in a sum of
  // kNoiseSide samples.
  const double samples = static_cast<double>(std::max<std::int64_t>(windows, 1)) * kNoiseSide * kNoiseSide;
  const double least_lag = 3.0 * mean.square / std::sqrt(samples);
  const double least_offset = 3.0 * mean.square * std::sqrt(2.0 / kNoiseSide / samples);
  Chosen chosen;
  chosen.fill(true);
  Sizes sizes{};
  for (;;) {
    sizes = solve(moments, chosen);
    Chosen fewer = chosen;
    for (const std::size_t lags : {kRowLags, kColumnLags}) {
      bool seen = true;
      for (std::size_t k = 0; k < kNoiseLags; ++k) {
        seen = seen && std::abs(sizes[lags + k]) > least_lag;
        fewer[lags + k] = fewer[lags + k] && seen;
      }
    }
    for (const std::size_t offset : {kRows, kColumns})
      fewer[offset] = fewer[offset] && sizes[offset] > least_offset;
    if (fewer == chosen) break;
    chosen = fewer;
  }
  // Along `lines` the noise may be correlated, across them it is not.
  const bool by_rows = mean.column_detail >= mean.row_detail;
  const std::size_t lines = by_rows ? kRowLags : kColumnLags, across = by_rows ? kColumnLags : kRowLags;
  const double variance = std::max(mean.row_detail, mean.column_detail);
  NoiseParts parts;
  // What rows and columns have alike is a rough surface.
  double& offset = by_rows ? parts.row_offset : parts.column_offset;
  offset = std::clamp(sizes[by_rows ? kRows : kColumns] - sizes[by_rows ? kColumns : kRows], 0.0, variance);
  std::array<double, kNoiseLags>& along = by_rows ? parts.along_row : parts.along_column;
  for (std::size_t k = 0; k < kNoiseLags; ++k) {
    const double rest = sizes[lines + k] - sizes[across + k];
    if (std::abs(rest) <= least_lag) break;
    along[k] = std::clamp(rest, offset - variance, variance - offset);
  }
  // Of white noise a squared fourth difference has 2.63 times the variance that it had if all were independent; both
  // directions' differ by the root of the double of that.
  agreeWithMissing(offset, along, variance, std::abs(mean.column_detail - mean.row_detail),
                   variance * std::sqrt(4.0 * 2.63 / samples));
  parts.uncorrelated = variance - offset;
  return parts;
}

}  // namespace fettle::engine
