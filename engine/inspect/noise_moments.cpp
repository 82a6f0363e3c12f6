#include "engine/inspect/noise_moments.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "engine/inspect/noise_polynomials.h"

namespace fettle::engine {

namespace {

constexpr std::size_t kSide = kNoiseSide, kLags = kNoiseLags;
constexpr std::size_t kDegrees = kNoiseDegrees, kAllDegrees = kNoiseAllDegrees;

using Window = std::array<double, kSide * kSide>;
using Coefficients = std::array<std::array<double, kAllDegrees>, kAllDegrees>;  // [along columns][along rows]

// Of the polynomials of less than `degrees`.
Coefficients coefficientsOf(const Window& z, std::size_t degrees) noexcept {
  const NoisePolynomials& p = noisePolynomials();
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
  const NoisePolynomials& p = noisePolynomials();
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

}  // namespace fettle::engine
