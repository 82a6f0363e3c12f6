#include "engine/measure/wave_fit.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <vector>

#include <tbb/parallel_for.h>
#include <Eigen/Dense>

namespace fettle::engine {

namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

constexpr int kMostPasses = 8;
constexpr double kEnough = 1e-3;  // of a wave over the surface

// Sums over the samples of a row, of place x from -1/2 to 1/2, phase phi and height z.
struct RowSums {
  double count = 0.0, height = 0.0;
  double powers[3] = {};  // of x^k
  Complex waves[2];       // of x^k exp(i phi)
  Complex doubled[3];     // of x^k exp(2 i phi)
  Complex heights[2];     // of x^k z exp(i phi)
};

double centredPlace(std::int32_t i, std::int32_t side) noexcept {
  return (i - 0.5 * (side - 1)) / side;
}

RowSums rowSums(const Surface& surface, std::int32_t row, const WavesOver& at) {
  RowSums sums;
  Complex wave = std::polar(
      1.0,
      2.0 * pi * (at.columns * centredPlace(0, surface.width) + at.rows * centredPlace(row, surface.height)));
  const Complex step = std::polar(1.0, 2.0 * pi * at.columns / surface.width);
  for (std::int32_t c = 0; c < surface.width; ++c, wave *= step) {
    const double z = surface.at(c, row);
    if (std::isnan(z)) continue;
    const double x = centredPlace(c, surface.width);
    const Complex twice = wave * wave, high = z * wave;
    sums.count += 1.0;
    sums.height += z;
    sums.powers[1] += x;
    sums.powers[2] += x * x;
    sums.waves[0] += wave;
    sums.waves[1] += x * wave;
    sums.doubled[0] += twice;
    sums.doubled[1] += x * twice;
    sums.doubled[2] += x * x * twice;
    sums.heights[0] += high;
    sums.heights[1] += x * high;
  }
  sums.powers[0] = sums.count;
  return sums;
}

// Of 1, cos, sin, x cos, x sin, y cos, y sin: their products with each other and with the heights.
struct NormalSums {
  Eigen::Matrix<double, 7, 7> products = Eigen::Matrix<double, 7, 7>::Zero();
  Eigen::Matrix<double, 7, 1> heights = Eigen::Matrix<double, 7, 1>::Zero();

  void add(const RowSums& row, double y) {
    const Complex waves[3] = {row.waves[0], row.waves[1], y * row.waves[0]};
    const Complex high[3] = {row.heights[0], row.heights[1], y * row.heights[0]};
    products(0, 0) += row.count;
    heights(0) += row.height;
    for (int i = 0; i < 3; ++i) {
      const int c = 1 + 2 * i, s = c + 1;
      heights(c) += high[i].real();
      heights(s) += high[i].imag();
      products(0, c) += waves[i].real();
      products(0, s) += waves[i].imag();
      for (int j = 0; j < 3; ++j) {
        // The power of x in the product, and what y adds to it.
        const int power = (i == 1 ? 1 : 0) + (j == 1 ? 1 : 0);
        const double by = (i == 2 ? y : 1.0) * (j == 2 ? y : 1.0);
        const double even = 0.5 * by * row.powers[power];
        const Complex twice = 0.5 * by * row.doubled[power];
        products(c, 1 + 2 * j) += even + twice.real();
        products(s, 2 + 2 * j) += even - twice.real();
        products(c, 2 + 2 * j) += twice.imag();
        products(s, 1 + 2 * j) += twice.imag();
      }
    }
  }
};

// The best wave of these frequencies, and the step to better ones.
struct Fit {
  double explained = 0.0;
  WavesOver step;
};

Fit waveFitOf(const NormalSums& sums) {
  const Eigen::Vector3d wave =
      sums.products.topLeftCorner<3, 3>().selfadjointView<Eigen::Upper>().ldlt().solve(
          sums.heights.head<3>());
  Fit fit;
  fit.explained = wave.dot(sums.heights.head<3>());
  // The model's derivatives in the basis: of its three numbers, and 2 pi x (B cos - A sin), 2 pi y (B cos - A sin).
  Eigen::Matrix<double, 7, 5> change = Eigen::Matrix<double, 7, 5>::Zero();
  change.topLeftCorner<3, 3>().setIdentity();
  for (int k = 0; k < 2; ++k) {
    change(3 + 2 * k, 3 + k) = 2.0 * pi * wave(2);
    change(4 + 2 * k, 3 + k) = -2.0 * pi * wave(1);
  }
  Eigen::Matrix<double, 7, 7> products = sums.products;
  products.col(0) = products.row(0).transpose();
  const Eigen::Matrix<double, 7, 1> left = sums.heights - products.leftCols<3>() * wave;
  const Eigen::Matrix<double, 5, 5> normal = change.transpose() * products * change;
  const Eigen::Matrix<double, 5, 1> step = normal.ldlt().solve(change.transpose() * left);
  if (step.allFinite()) fit.step = {step(3), step(4)};
  return fit;
}

}  // namespace

WavesOver nearestWave(const Surface& surface, const WavesOver& start, JobControl& job) {
  std::vector<RowSums> rows(static_cast<std::size_t>(surface.height));
  const auto fitAt = [&](const WavesOver& at) {
    tbb::parallel_for(0, surface.height, [&](std::int32_t r) {
      if (!job.cancelled()) rows[static_cast<std::size_t>(r)] = rowSums(surface, r, at);
    });
    NormalSums sums;
    for (std::int32_t r = 0; r < surface.height; ++r)
      sums.add(rows[static_cast<std::size_t>(r)], centredPlace(r, surface.height));
    return waveFitOf(sums);
  };
  const auto moved = [&](const WavesOver& from, const WavesOver& by, double share) {
    return WavesOver{std::clamp(from.columns + share * by.columns, start.columns - 1.0, start.columns + 1.0),
                     std::clamp(from.rows + share * by.rows, start.rows - 1.0, start.rows + 1.0)};
  };
  WavesOver best = start;
  Fit fit = fitAt(best);
  double share = 1.0;
  for (int pass = 1; pass < kMostPasses && !job.cancelled(); ++pass) {
    const WavesOver next = moved(best, fit.step, share);
    const double far = std::hypot(next.columns - best.columns, next.rows - best.rows);
    if (far == 0.0) break;
    const Fit there = fitAt(next);
    if (there.explained >= fit.explained) {
      best = next;
      fit = there;
      share = 1.0;
      // The next step is that much shorter again.
      if (far < kEnough) break;
    } else {
      share *= 0.25;
      if (far < kEnough) break;
    }
  }
  return best;
}

}  // namespace fettle::engine
