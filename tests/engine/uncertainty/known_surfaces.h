// Surfaces of a root mean square height of about 1 whose parameters are known without noise.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "engine/field/builder.h"

namespace fettle::tests {

using std::numbers::pi;
inline constexpr int kSide = 128;

inline engine::Version fieldOf(const std::vector<double>& heights) {
  engine::Grid grid;
  grid.width = kSide;
  grid.height = kSide;
  std::vector<float> z(heights.begin(), heights.end());
  return engine::makeField(grid, z, {});
}

// White noise through a Gaussian of `a` samples along a line at `degrees` and `b` across it, of mean square 1.
inline std::vector<double> randomTexture(double a, double b, double degrees, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const int reach = static_cast<int>(std::ceil(3.0 * std::max(a, b)));
  const int wide = kSide + 2 * reach;
  std::vector<double> noise(static_cast<std::size_t>(wide) * wide);
  for (double& z : noise) z = normal(random);
  const double cosine = std::cos(degrees * pi / 180.0), sine = std::sin(degrees * pi / 180.0);
  std::vector<double> kernel;
  double squares = 0.0;
  for (int r = -reach; r <= reach; ++r)
    for (int c = -reach; c <= reach; ++c) {
      const double u = (c * cosine + r * sine) / a, v = (r * cosine - c * sine) / b;
      kernel.push_back(std::exp(-0.5 * (u * u + v * v)));
      squares += kernel.back() * kernel.back();
    }
  std::vector<double> heights;
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column) {
      double sum = 0.0;
      std::size_t k = 0;
      for (int r = 0; r <= 2 * reach; ++r)
        for (int c = 0; c <= 2 * reach; ++c)
          sum += kernel[k++] *
                 noise[static_cast<std::size_t>(row + r) * wide + static_cast<std::size_t>(column + c)];
      heights.push_back(sum / std::sqrt(squares));
    }
  return heights;
}

inline std::vector<double> made(const std::function<double(int, int)>& z) {
  std::vector<double> heights;
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) heights.push_back(z(c, r));
  return heights;
}

inline std::vector<double> sumOf(double a, const std::vector<double>& x, double b,
                                 const std::vector<double>& y) {
  std::vector<double> sum;
  for (std::size_t i = 0; i < x.size(); ++i) sum.push_back(a * x[i] + b * y[i]);
  return sum;
}

// Surfaces of a root mean square height of about 1.
struct KnownSurface {
  const char* name;
  std::function<std::vector<double>()> heights;
};
inline const KnownSurface kSurfaces[] = {
    {"random", [] { return randomTexture(4.0, 4.0, 0.0, 11); }},
    {"lay at 30 degrees", [] { return randomTexture(9.0, 2.5, 30.0, 12); }},
    {"steps",
     [] {
       return made([](int c, int r) {
         return (c / 20 % 2 == 0 ? 1.0 : -1.0) + (r > 70 && r < 100 && c > 45 && c < 75 ? 1.5 : 0.0) +
                0.3 * std::sin(c * 0.11) * std::cos(r * 0.07);
       });
     }},
    {"waves",
     [] {
       return made([](int c, int r) {
         return std::sin(2.0 * pi * c / 23.0) + 0.8 * std::sin(2.0 * pi * r / 31.0 + 1.0);
       });
     }},
};

// Others, none of which anything was chosen on.
inline const KnownSurface kOtherSurfaces[] = {
    {"two roughnesses",
     [] { return sumOf(0.7, randomTexture(2.0, 2.0, 0.0, 21), 0.7, randomTexture(11.0, 11.0, 0.0, 22)); }},
    {"honed plateau",
     [] {
       std::vector<double> z = randomTexture(7.0, 2.0, -20.0, 23);
       for (double& height : z) height = 1.5 * (height > 0.2 ? 0.2 + 0.15 * (height - 0.2) : height);
       return z;
     }},
    {"dimples",
     [] {
       return made([](int c, int r) {
         const double x = c % 26 - 13.0 + 3.0 * (r / 26 % 2), y = r % 26 - 13.0, square = x * x + y * y;
         return 0.25 * std::sin(c * 0.19 + r * 0.05) - (square < 81.0 ? 0.035 * (81.0 - square) : 0.0);
       });
     }},
    {"grooves at 17 degrees",
     [] {
       const std::vector<double> grooves = made([](int c, int r) {
         const double across = c * std::cos(17.0 * pi / 180.0) + r * std::sin(17.0 * pi / 180.0);
         return 4.0 * std::abs(across / 14.0 - std::floor(across / 14.0 + 0.5)) - 1.0;
       });
       return sumOf(1.5, grooves, 0.3, randomTexture(5.0, 5.0, 0.0, 24));
     }},
};

// Long along rows or along columns, as what lines of a scanner share.
inline const KnownSurface kLays[] = {
    {"lay at 0", [] { return randomTexture(9.0, 3.0, 0.0, 31); }},
    {"lay at 90", [] { return randomTexture(9.0, 3.0, 90.0, 32); }},
};

}  // namespace fettle::tests
