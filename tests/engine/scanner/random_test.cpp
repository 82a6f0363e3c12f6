#include "engine/scanner/counter_random.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace fettle::engine {
namespace {

// Largest distance between the sample's distribution and `cdf` (Kolmogorov).
template <class Cdf>
double kolmogorov(std::vector<double> values, Cdf cdf) {
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  double worst = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double f = cdf(values[i]);
    const auto k = static_cast<double>(i);
    worst = std::max({worst, (k + 1.0) / n - f, f - k / n});
  }
  return worst;
}

// Critical value at significance 0.001 for large n: sqrt(-ln(0.0005) / 2) / sqrt(n) = 1.949 / sqrt(n).
double critical(std::size_t n) {
  return 1.949 / std::sqrt(static_cast<double>(n));
}

template <class F>
std::vector<double> over(int columns, int rows, F f) {
  std::vector<double> values;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) values.push_back(f(c, r));
  return values;
}

TEST(CounterRandom, UniformPassesKolmogorovAtOneInAThousandForSeveralSeeds) {
  for (const std::uint64_t seed : {0ULL, 1ULL, 2ULL, 0xffffffffffffffffULL}) {
    const CounterRandom random(seed, 3);
    const auto values = over(300, 300, [&](int c, int r) { return random.uniform(c, r); });
    EXPECT_LT(kolmogorov(values, [](double x) { return x; }), critical(values.size())) << seed;
  }
}

TEST(CounterRandom, NormalPassesKolmogorovAtOneInAThousand) {
  const CounterRandom random(7, 1);
  const auto values = over(300, 300, [&](int c, int r) { return random.normal(c, r); });
  const auto cdf = [](double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); };
  EXPECT_LT(kolmogorov(values, cdf), critical(values.size()));
}

TEST(CounterRandom, NeighboursStreamsAndSeedsAreUncorrelated) {
  // The mean of n products of independent standard normals has standard deviation 1 / sqrt(n); 3.9 of them
  // are exceeded with probability 1e-4 each, 6e-4 over the six pairs.
  const CounterRandom a(5, 1);
  const CounterRandom other_stream(5, 2);
  const CounterRandom other_seed(6, 1);
  constexpr int kSide = 300;
  const auto correlation = [&](auto&& f, auto&& g) {
    double sum = 0.0;
    for (int r = 0; r < kSide; ++r)
      for (int c = 0; c < kSide; ++c) sum += f(c, r) * g(c, r);
    return sum / (kSide * kSide);
  };
  const double bound = 3.9 / kSide;
  const auto here = [&](int c, int r) { return a.normal(c, r); };
  EXPECT_LT(std::abs(correlation(here, [&](int c, int r) { return a.normal(c + 1, r); })), bound);
  EXPECT_LT(std::abs(correlation(here, [&](int c, int r) { return a.normal(c, r + 1); })), bound);
  EXPECT_LT(std::abs(correlation(here, [&](int c, int r) { return a.normal(r, c) * (r == c ? 0.0 : 1.0); })),
            bound);
  EXPECT_LT(std::abs(correlation(here, [&](int c, int r) { return a.normal(c - kSide, r); })), bound);
  EXPECT_LT(std::abs(correlation(here, [&](int c, int r) { return other_stream.normal(c, r); })), bound);
  EXPECT_LT(std::abs(correlation(here, [&](int c, int r) { return other_seed.normal(c, r); })), bound);
}

TEST(CounterRandom, ExtremesStayFinite) {
  // The radius comes from 32 bits: sqrt(2 ln 2^33) = 6.76 is the largest there can be.
  const CounterRandom random(1, 1);
  for (const int c : {-2147483647 - 1, -1, 0, 2147483647})
    for (const int r : {-2147483647 - 1, -1, 0, 2147483647}) {
      EXPECT_LE(std::abs(random.normal(c, r)), 6.77);
      EXPECT_GE(random.uniform(c, r), 0.0);
      EXPECT_LT(random.uniform(c, r), 1.0);
    }
}

}  // namespace
}  // namespace fettle::engine
