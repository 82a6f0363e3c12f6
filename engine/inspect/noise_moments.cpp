#include "engine/inspect/noise_moments.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace fettle::engine {

namespace {

constexpr std::size_t kSide = kNoiseSide, kLags = kNoiseLags;
constexpr std::size_t kDegrees = 3;     // of the fit: 0, 1, 2
constexpr std::size_t kAllDegrees = 6;  // and of what shows that it does not follow the surface

using Window = std::array<double, kSide * kSide>;
using Polynomials = std::array<std::array<double, kSide>, kAllDegrees>;
using Coefficients = std::array<std::array<double, kAllDegrees>, kAllDegrees>;  // [along columns][along rows]

// Orthonormal polynomials on equally spaced points (Gram 1883), by Gram and Schmidt's steps.
Polynomials makePolynomials() noexcept {
  Polynomials made{};
  for (std::size_t d = 0; d < kAllDegrees; ++d) {
    std::array<double, kSide>& p = made[d];
    for (std::size_t i = 0; i < kSide; ++i)
      p[i] = std::pow((static_cast<double>(i) - 0.5 * (kSide - 1)) / kSide, static_cast<double>(d));
    for (std::size_t e = 0; e < d; ++e) {
      double common = 0.0;
      for (std::size_t i = 0; i < kSide; ++i) common += p[i] * made[e][i];
      for (std::size_t i = 0; i < kSide; ++i) p[i] -= common * made[e][i];
    }
    double square = 0.0;
    for (const double value : p) square += value * value;
    for (double& value : p) value /= std::sqrt(square);
  }
  return made;
}

const Polynomials& polynomials() noexcept {
  static const Polynomials made = makePolynomials();
  return made;
}

// Of the polynomials of less than `degrees`.
Coefficients coefficientsOf(const Window& z, std::size_t degrees) noexcept {
  const Polynomials& p = polynomials();
  Coefficients sizes{};
  for (std::size_t r = 0; r < kSide; ++r)
    for (std::size_t d = 0; d < degrees; ++d) {
      double along_row = 0.0;
      for (std::size_t c = 0; c < kSide; ++c) along_row += p[d][c] * z[r * kSide + c];
      for (std::size_t e = 0; e < degrees; ++e) sizes[e][d] += p[e][r] * along_row;
    }
  return sizes;
}

// The polynomials that fit `z` best.
void fit(const Window& z, Window& fitted) noexcept {
  const Polynomials& p = polynomials();
  const Coefficients sizes = coefficientsOf(z, kDegrees);
  for (std::size_t r = 0; r < kSide; ++r) {
    std::array<double, kDegrees> row{};
    for (std::size_t d = 0; d < kDegrees; ++d)
      for (std::size_t e = 0; e < kDegrees; ++e) row[d] += sizes[e][d] * p[e][r];
    for (std::size_t c = 0; c < kSide; ++c)
      fitted[r * kSide + c] = row[0] * p[0][c] + row[1] * p[1][c] + row[2] * p[2][c];
  }
}

// Which samples count, and what is left of them.
struct Rest {
  Window r{};  // 0 where none counts
  std::array<bool, kSide * kSide> counts{};
};

// Of the smallest three quarters of the squares of standard normal numbers.
constexpr double kMeanOfSmallest = 0.368;

// Mean of the three smallest quarters of what Immerkaer's mask (noise.h) gives, squared: the rest may be an edge.
double finestDetail(const Rest& rest) noexcept {
  std::array<double, (kSide - 2) * (kSide - 2)> squares;
  std::size_t count = 0;
  const auto across = [&](std::size_t at) { return rest.r[at - 1] - 2.0 * rest.r[at] + rest.r[at + 1]; };
  const auto known = [&](std::size_t at) {
    return rest.counts[at - 1] && rest.counts[at] && rest.counts[at + 1];
  };
  for (std::size_t r = 1; r + 1 < kSide; ++r)
    for (std::size_t c = 1; c + 1 < kSide; ++c) {
      const std::size_t at = r * kSide + c;
      if (!known(at - kSide) || !known(at) || !known(at + kSide)) continue;
      const double d = across(at - kSide) - 2.0 * across(at) + across(at + kSide);
      squares[count++] = d * d / 36.0;
    }
  const std::size_t used = count * 3 / 4;
  std::nth_element(squares.begin(), squares.begin() + static_cast<std::ptrdiff_t>(used),
                   squares.begin() + static_cast<std::ptrdiff_t>(count));
  double sum = 0.0;
  for (std::size_t i = 0; i < used; ++i) sum += squares[i];
  return used > 0 ? sum / static_cast<double>(used) : 0.0;
}

// NoiseWindow::surface.
std::array<double, 4> surfaceOf(const Rest& rest, double square, double detail) noexcept {
  const Coefficients sizes = coefficientsOf(rest.r, kAllDegrees);
  std::array<double, 4> squares{0.0, 0.0, 0.0, square};
  for (std::size_t e = 0; e < kAllDegrees; ++e)
    for (std::size_t d = 0; d < kAllDegrees; ++d)
      if (d >= kDegrees || e >= kDegrees) squares[e == 0 ? 0 : d == 0 ? 1 : 2] += sizes[e][d] * sizes[e][d];
  for (std::size_t g = 0; g < kNoiseGroupSizes.size(); ++g) squares[g] /= kNoiseGroupSizes[g];
  for (double& group : squares) group = group > 0.0 ? group / detail : 0.0;
  return squares;
}

// Mean product of samples `step` apart; `side` of each row of them is lost.
double meanProduct(const Rest& rest, std::size_t across, std::size_t up) noexcept {
  double sum = 0.0;
  int pairs = 0;
  for (std::size_t r = 0; r + up < kSide; ++r)
    for (std::size_t c = 0; c + across < kSide; ++c) {
      const std::size_t a = r * kSide + c, b = (r + up) * kSide + c + across;
      sum += rest.r[a] * rest.r[b];
      pairs += rest.counts[a] && rest.counts[b];
    }
  return pairs > 0 ? sum / pairs : 0.0;
}

// Mean of squared sums along rows (`step` 1, `next` kSide) or columns, each over its number of samples.
double meanSum(const Rest& rest, std::size_t step, std::size_t next) noexcept {
  double squares = 0.0;
  for (std::size_t k = 0; k < kSide; ++k) {
    double sum = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < kSide; ++i) {
      sum += rest.r[k * next + i * step];
      count += rest.counts[k * next + i * step];
    }
    if (count > 0) squares += sum * sum / count;
  }
  return squares / kSide;
}

// Mean of squared fourth differences of samples `step` apart in the window, over 70.
double meanDetail(const Rest& rest, std::size_t step) noexcept {
  double squares = 0.0;
  int count = 0;
  const std::size_t columns = step == 1 ? kSide - 4 : kSide, rows = step == 1 ? kSide : kSide - 4;
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t c = 0; c < columns; ++c) {
      const std::size_t at = r * kSide + c;
      bool known = true;
      for (std::size_t k = 0; k < 5; ++k) known = known && rest.counts[at + k * step];
      if (!known) continue;
      const double* z = &rest.r[at];
      const double d = (z[0] + z[4 * step]) - 4.0 * (z[step] + z[3 * step]) + 6.0 * z[2 * step];
      squares += d * d;
      ++count;
    }
  return count > 0 ? squares / (70.0 * count) : 0.0;
}

NoiseMoments momentsOf(const Rest& rest) noexcept {
  NoiseMoments m;
  m.square = meanProduct(rest, 0, 0);
  for (std::size_t k = 0; k < kLags; ++k) {
    m.along_row[k] = meanProduct(rest, k + 1, 0);
    m.along_column[k] = meanProduct(rest, 0, k + 1);
  }
  m.row_sum = meanSum(rest, 1, kSide);
  m.column_sum = meanSum(rest, kSide, 1);
  m.row_detail = meanDetail(rest, 1);
  m.column_detail = meanDetail(rest, kSide);
  return m;
}

// A moment, or a part of the noise, is a form along rows times one along columns. Forms: 0 the same sample, 1 ..
// kLags that many apart, then all.
constexpr std::size_t kForms = kLags + 2, kAll = kLags + 1;
struct Pair {
  std::size_t across, up;
};
// The sample itself; rows' lags; columns' lags; whole rows; whole columns.
constexpr std::size_t kParts = 2 * kLags + 3;
constexpr std::size_t kRowLags = 1, kColumnLags = 1 + kLags, kRows = 1 + 2 * kLags, kColumns = kRows + 1;

constexpr Pair partOf(std::size_t i) noexcept {
  if (i == 0) return {0, 0};
  if (i < kColumnLags) return {i, 0};
  if (i < kRows) return {0, i - kLags};
  return i == kRows ? Pair{kAll, 0} : Pair{0, kAll};
}

using Matrix = std::array<std::array<double, kSide>, kSide>;

Matrix formOf(std::size_t form) noexcept {
  Matrix m{};
  for (std::size_t i = 0; i < kSide; ++i)
    for (std::size_t j = 0; j < kSide; ++j)
      m[i][j] = form == kAll || (i > j ? i - j : j - i) == form ? 1.0 : 0.0;
  return m;
}

Matrix times(const Matrix& a, const Matrix& b) noexcept {
  Matrix m{};
  for (std::size_t i = 0; i < kSide; ++i)
    for (std::size_t k = 0; k < kSide; ++k)
      for (std::size_t j = 0; j < kSide; ++j) m[i][j] += a[i][k] * b[k][j];
  return m;
}

// Mean of b's elements where `a` is 1; of all over the side, as sums are.
double meanWhere(const Matrix& a, const Matrix& b, std::size_t form) noexcept {
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < kSide; ++i)
    for (std::size_t j = 0; j < kSide; ++j) sum += a[i][j] * b[i][j], count += a[i][j];
  return sum / (form == kAll ? static_cast<double>(kSide) : count);
}

// expected[m][p]: moment m of what the fit leaves of part p with size 1. For a part A x B (along rows, along
// columns) and the projections P of either direction, (1 - P x P)(A x B)(1 - P x P) is A x B less PA x PB less its
// transpose plus PAP x PBP.
using Table = std::array<std::array<double, kParts>, kParts>;

Table makeExpected() noexcept {
  const Polynomials& p = polynomials();
  Matrix projection{};
  for (std::size_t d = 0; d < kDegrees; ++d)
    for (std::size_t i = 0; i < kSide; ++i)
      for (std::size_t j = 0; j < kSide; ++j) projection[i][j] += p[d][i] * p[d][j];
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

}  // namespace

void NoiseMoments::add(const NoiseMoments& other, double weight) noexcept {
  square += weight * other.square;
  for (std::size_t k = 0; k < kLags; ++k) {
    along_row[k] += weight * other.along_row[k];
    along_column[k] += weight * other.along_column[k];
  }
  row_sum += weight * other.row_sum;
  column_sum += weight * other.column_sum;
  row_detail += weight * other.row_detail;
  column_detail += weight * other.column_detail;
}

void NoiseParts::scale(double factor) noexcept {
  uncorrelated *= factor;
  row_offset *= factor;
  column_offset *= factor;
  for (double& part : along_row) part *= factor;
  for (double& part : along_column) part *= factor;
}

NoiseWindow noiseWindow(const std::array<float, kNoiseSide * kNoiseSide>& heights) noexcept {
  constexpr double kSpike = 5.0;
  constexpr int kRounds = 12;  // a missing corner is then known to a tenth of the noise
  NoiseWindow window;
  Rest rest;
  Window z{}, fitted{};
  double first = 0.0;
  bool any = false;
  for (std::size_t i = 0; i < z.size(); ++i) {
    rest.counts[i] = heights[i] == heights[i];
    if (!rest.counts[i]) continue;
    if (!any) first = static_cast<double>(heights[i]);
    any = true;
    z[i] = static_cast<double>(heights[i]) - first;
    ++window.known;
  }
  if (!window.usable()) return window;
  for (int round = 0; round < kRounds; ++round) {
    fit(z, fitted);
    double squares = 0.0;
    for (std::size_t i = 0; i < z.size(); ++i) {
      rest.r[i] = rest.counts[i] ? z[i] - fitted[i] : 0.0;
      squares += rest.r[i] * rest.r[i];
    }
    const double far = kSpike * std::sqrt(squares / window.known);
    int spikes = 0;
    for (std::size_t i = 0; i < z.size(); ++i)
      if (std::abs(rest.r[i]) > far) rest.counts[i] = false, rest.r[i] = 0.0, ++spikes;
    window.known -= spikes;
    if (!window.usable()) return window;
    if (window.known == kNoiseSide * kNoiseSide) break;
    for (std::size_t i = 0; i < z.size(); ++i)
      if (!rest.counts[i]) z[i] = fitted[i];
  }
  window.moments = momentsOf(rest);
  const double detail = finestDetail(rest);
  window.surface = surfaceOf(rest, window.moments.square, detail);
  window.finest = detail / kMeanOfSmallest;
  return window;
}

NoiseParts noiseOf(const NoiseMoments& mean, std::int64_t windows) noexcept {
  Sizes moments{};
  moments[0] = mean.square;
  for (std::size_t k = 0; k < kLags; ++k) {
    moments[kRowLags + k] = mean.along_row[k];
    moments[kColumnLags + k] = mean.along_column[k];
  }
  moments[kRows] = mean.row_sum;
  moments[kColumns] = mean.column_sum;
  // Standard errors in white noise: of a product 1 / sqrt(samples), of a squared sum sqrt(2 / rows), in a sum of
  // kSide samples.
  const double samples = static_cast<double>(std::max<std::int64_t>(windows, 1)) * kSide * kSide;
  const double least_lag = 3.0 * mean.square / std::sqrt(samples);
  const double least_offset = 3.0 * mean.square * std::sqrt(2.0 / kSide / samples);
  Chosen chosen;
  chosen.fill(true);
  Sizes sizes{};
  for (;;) {
    sizes = solve(moments, chosen);
    Chosen fewer = chosen;
    for (const std::size_t lags : {kRowLags, kColumnLags}) {
      bool seen = true;
      for (std::size_t k = 0; k < kLags; ++k) {
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
  const double offset =
      std::clamp(sizes[by_rows ? kRows : kColumns] - sizes[by_rows ? kColumns : kRows], 0.0, variance);
  (by_rows ? parts.row_offset : parts.column_offset) = offset;
  parts.uncorrelated = variance - offset;
  std::array<double, kNoiseLags>& along = by_rows ? parts.along_row : parts.along_column;
  for (std::size_t k = 0; k < kLags; ++k) {
    const double rest = sizes[lines + k] - sizes[across + k];
    if (std::abs(rest) <= least_lag) break;
    along[k] = std::clamp(rest, -parts.uncorrelated, parts.uncorrelated);
  }
  return parts;
}

}  // namespace fettle::engine
