#pragma once

// The robust filters by their definition, all samples for each one: slow.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "engine/filter/gaussian_regression.h"
#include "engine/filter/robust_weights.h"
#include "tests/engine/filter/made_scan.h"

namespace fettle::engine::tests {

/// The polynomial of second degree by normal equations over all samples there are, and how near a term was to being left out or
/// the weights to being none: a factor.
struct PlainHeight {
  double z = 0.0, clearance = std::numeric_limits<double>::infinity();
  double distance = 0.0;  // the mean one of the window's samples
  double weight = 0.0;    // of all, 1 being that of a sample at the place
};

inline PlainHeight plainHeight(const MadeScan& scan, const std::vector<double>& z,
                               const std::vector<double>& weights, int column, int row) {
  using Real = double;
  Real a[6][7] = {};
  const Real deviation = 0.7309134280946760 / std::sqrt(2 * std::numbers::pi_v<Real>) * scan.nesting;
  double total = 0.0, distances = 0.0;
  const double here = z[static_cast<std::size_t>(row * scan.width + column)];
  for (int r = 0; r < scan.height; ++r)
    for (int c = 0; c < scan.width; ++c) {
      const auto at = static_cast<std::size_t>(r * scan.width + c);
      if (std::isnan(z[at]) || !(weights[at] > 0.0)) continue;
      const Real x = (c - column) * scan.spacing_x / deviation, y = (r - row) * scan.spacing_y / deviation;
      if (x * x + y * y > 60) continue;  // 1e-13 and less
      const Real w = weights[at] * std::exp(-(x * x + y * y) / 2);
      const Real terms[] = {1, x, y, x * x, x * y, y * y, z[at]};
      for (int p = 0; p < 6; ++p)
        for (int q = p; q < 7; ++q) a[p][q] += w * terms[p] * terms[q];
      total += static_cast<double>(w);
      distances += static_cast<double>(w) * std::fabs(z[at] - (std::isnan(here) ? 0.0 : here));
    }
  PlainHeight plain;
  plain.distance = distances / total;
  plain.weight = total;
  const auto passes = [&](double value, double least) {
    if (value > 0.0) plain.clearance = std::min(plain.clearance, std::max(value / least, least / value));
    return value > least;
  };
  if (!passes(total, GaussianRegression::kLeastWeight)) {
    plain.z = std::nan("");
    return plain;
  }
  Real whole[6], x[6] = {};
  bool there[6];
  for (int k = 0; k < 6; ++k) whole[k] = a[k][k];
  for (int k = 0; k < 6; ++k) {
    // What rounding leaves of nothing is nothing.
    there[k] = whole[k] > 0 && passes(static_cast<double>(std::max(a[k][k] / whole[k], 1e-12)),
                                      GaussianRegression::kLeastDetermined);
    for (int p = k + 1; p < 6 && there[k]; ++p) {
      const Real share = a[k][p] / a[k][k];
      for (int q = p; q < 7; ++q) a[p][q] -= share * a[k][q];
    }
  }
  for (int k = 5; k >= 0; --k) {
    if (!there[k]) continue;
    x[k] = a[k][6];
    for (int q = k + 1; q < 6; ++q) x[k] -= a[k][q] * x[q];
    x[k] /= a[k][k];
  }
  plain.z = static_cast<double>(x[0]);
  return plain;
}

/// Of each sample the surface, and the weights of the last round: round by round, medians of all distances.
struct PlainRobust {
  std::vector<double> surface, weights;
  double limit = 0.0;
  int rounds = 0;
};

inline PlainRobust plainRobust(const MadeScan& scan, const std::vector<double>& z) {
  const std::size_t count = z.size();
  const auto surfaceOf = [&](const std::vector<double>& heights, const std::vector<double>& weights,
                             const std::vector<double>& before) {
    std::vector<double> surface;
    for (std::size_t i = 0; i < count; ++i) {
      const double height = plainHeight(scan, heights, weights, static_cast<int>(i) % scan.width,
                                        static_cast<int>(i) / scan.width)
                                .z;
      surface.push_back(std::isnan(height) && !before.empty() ? before[i] : height);
    }
    return surface;
  };
  const std::vector<double> ones(count, 1.0);
  PlainRobust plain{{}, ones};
  for (; plain.rounds < kMostRobustRounds; ++plain.rounds) {
    plain.surface = surfaceOf(z, plain.weights, plain.surface);
    std::vector<double> distances, held = plain.surface;
    for (std::size_t i = 0; i < count; ++i)
      if (std::isnan(z[i]))
        held[i] = z[i];
      else
        distances.push_back(std::fabs(z[i] - plain.surface[i]));
    std::ranges::sort(distances);
    const std::size_t n = distances.size();
    const double next = kRobustLimit * 0.5 * (distances[(n - 1) / 2] + distances[n / 2]);
    const bool ends = !(next > 0.0) || std::fabs(next - plain.limit) <= kRobustTolerance * plain.limit;
    plain.limit = next;
    if (ends) break;
    const std::vector<double> smoother = surfaceOf(held, ones, {});
    for (std::size_t i = 0; i < count; ++i) {
      if (std::isnan(z[i])) continue;
      const double r = z[i] - plain.surface[i], bend = plain.surface[i] - smoother[i];
      const double off =
          r * bend > 0.0 ? std::max(std::fabs(r) - kRobustBend * std::fabs(bend), 0.0) : std::fabs(r);
      const double rest = 1.0 - off / plain.limit * off / plain.limit;
      plain.weights[i] = rest > 0.0 ? rest * rest : 0.0;
    }
  }
  return plain;
}

}  // namespace fettle::engine::tests
