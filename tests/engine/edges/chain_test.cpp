#include "engine/edges/chain.h"

#include <cmath>

#include <gtest/gtest.h>

namespace fettle::engine {
namespace {

constexpr Offsets kOffsets{2.0};

// Quadratic costs about centre(i), of standard deviation `deviation`.
template <class Centre>
ChainCosts quadratic(int points, double deviation, Centre&& centre) {
  ChainCosts costs{kOffsets, {}};
  for (int i = 0; i < points; ++i)
    for (int k = 0; k < kOffsets.count(); ++k) {
      const double off = (kOffsets.at(k) - centre(i)) / deviation;
      costs.costs.push_back(static_cast<float>(off * off));
    }
  return costs;
}

TEST(Chain, DeviationIsThatOfTheLeastSquaresSolution) {
  // A random walk of step q observed with deviation r: in the middle of a long line the variance is
  // q r / 2 / sqrt(1 + (q / 2 r)^2) (the stationary smoother). Here 0.33; changes by whole quarters cannot
  // follow it exactly.
  constexpr double kStep = 0.5, kNoise = 0.5;
  const Chain chain = chainAlong(quadratic(301, kNoise, [](int) { return 0.25; }), kStep, false);
  const double expected =
      std::sqrt(0.5 * kStep * kNoise / std::sqrt(1.0 + 0.25 * kStep * kStep / (kNoise * kNoise)));
  EXPECT_NEAR(chain.mean[150], 0.25, 1e-6);
  EXPECT_NEAR(chain.deviation[150], expected, 0.1 * expected);
}

TEST(Chain, FollowsASlowChangeAndIgnoresALonePoint) {
  ChainCosts costs = quadratic(120, 0.3, [](int i) { return 1.5 * std::sin(i / 20.0); });
  const Chain smooth = chainAlong(costs, 0.25, false);
  for (int i = 5; i < 115; ++i)
    EXPECT_NEAR(smooth.mean[static_cast<std::size_t>(i)], 1.5 * std::sin(i / 20.0), 0.12) << i;
  const ChainCosts still = quadratic(60, 0.5, [](int i) { return i == 30 ? 1.75 : 0.0; });
  EXPECT_NEAR(chainAlong(still, 0.1, false).mean[30], 0.0, 0.25);
}

TEST(Chain, ClosedLineHasNoSeam) {
  // The same costs from another start give the same way, moved.
  constexpr int kPoints = 150;
  const auto wave = [](int i) { return std::sin(2.0 * 3.14159265358979 * i / kPoints * 3.0); };
  const Chain one = chainAlong(quadratic(kPoints, 0.4, wave), 0.25, true);
  const Chain other = chainAlong(quadratic(kPoints, 0.4, [&](int i) { return wave(i + 40); }), 0.25, true);
  for (int i = 0; i < kPoints; ++i)
    EXPECT_NEAR(one.mean[static_cast<std::size_t>((i + 40) % kPoints)],
                other.mean[static_cast<std::size_t>(i)], 1e-4)
        << i;
}

TEST(Chain, OnePointAndHugeCosts) {
  EXPECT_NEAR(chainAlong(quadratic(1, 0.5, [](int) { return 0.5; }), 0.25, false).mean[0], 0.5, 1e-3);
  ChainCosts costs = quadratic(50, 0.5, [](int) { return 0.5; });
  for (float& cost : costs.costs) cost += 1e7F;  // what every offset has in common does not matter
  const Chain chain = chainAlong(costs, 0.25, false);
  EXPECT_NEAR(chain.mean[25], 0.5, 0.3);  // floats of 1e7 are 1 apart
  EXPECT_TRUE(std::isfinite(chain.deviation[25]));
}

}  // namespace
}  // namespace fettle::engine
