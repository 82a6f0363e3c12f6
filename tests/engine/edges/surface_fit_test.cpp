#include "engine/edges/surface_fit.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "tests/engine/edges/edge_fields.h"

namespace fettle::engine {
namespace {

Moments momentsOf(int low, int high, const std::function<double(int, int)>& z) {
  Moments m;
  for (int d = low; d <= high; ++d)
    for (int s = -4; s <= 4; ++s) m.add(d, s, z(d, s));
  return m;
}

TEST(SurfaceFit, PlaneIsExactUpToLevelling) {
  const PlaneFit fit = fitPlane(momentsOf(-6, 6, [](int d, int s) { return 3.0 + 0.5 * d - 0.25 * s; }));
  // The levelling takes kLevelling / (sum of squares) off the slopes: 117 samples, 1638 and 780.
  EXPECT_NEAR(fit.at(0.0, 0.0), 3.0, 1e-12);
  EXPECT_NEAR(fit.slope_d, 0.5, 0.5 * kLevelling / 1638.0 + 1e-12);
  EXPECT_NEAR(fit.slope_s, -0.25, 0.25 * kLevelling / 780.0 + 1e-12);
  EXPECT_LT(fit.residual, 1e-3);
}

TEST(SurfaceFit, VarianceIsThatOfTheNoiseAndPredictsItsOwnError) {
  // Over many fits the error of the height at a point and of the slopes has the predicted variance.
  double height = 0.0, slope = 0.0, variance = 0.0;
  constexpr int kFits = 400;
  PlaneFit fit;
  for (int k = 0; k < kFits; ++k) {
    fit = fitPlane(
        momentsOf(1, 8, [&](int d, int s) { return whiteNoise(d, s, static_cast<std::uint64_t>(k)); }));
    height += fit.at(0.0, 0.0) * fit.at(0.0, 0.0) / kFits;
    slope += fit.slope_d * fit.slope_d / kFits;
    variance += fit.variance() / kFits;
  }
  // A variance of 400 normal numbers is off by less than 4 sqrt(2 / 400) = 0.28 of it.
  EXPECT_NEAR(height / fit.varianceAt(0.0, 0.0), 1.0, 0.28);
  EXPECT_NEAR(slope / fit.inverse_dd, 1.0, 0.28);
  EXPECT_NEAR(variance, 1.0, 0.05);
}

TEST(SurfaceFit, FewSamplesGiveALevelAndOneRowGivesAPlaneAlongIt) {
  EXPECT_EQ(fitPlane({}).residual, 0.0);
  EXPECT_EQ(fitPlane({}).at(1.0, 1.0), 0.0);
  Moments two;
  two.add(0.0, 0.0, 1.0);
  two.add(1.0, 0.0, 3.0);
  EXPECT_DOUBLE_EQ(fitPlane(two).at(7.0, 7.0), 2.0);
  EXPECT_DOUBLE_EQ(fitPlane(two).residual, 2.0);
  Moments row;
  for (int d = 0; d < 20; ++d) row.add(d, 2.0, 0.5 * d);
  EXPECT_NEAR(fitPlane(row).slope_d, 0.5, 1e-5);
  EXPECT_NEAR(fitPlane(row).slope_s, 0.0, 1e-9);
}

TEST(SurfaceFit, HingeFitsARoofAndNotAStep) {
  const auto roof = [](int d, int s) { return 1.0 + 0.3 * d + 0.1 * s - 0.8 * std::max(0, d - 2); };
  EXPECT_LT(hingeResidual(momentsOf(-6, 1, roof), momentsOf(2, 9, roof), 2.0), 0.01);
  EXPECT_GT(hingeResidual(momentsOf(-6, 0, roof), momentsOf(1, 9, roof), -1.0), 1.0);
  const auto step = [](int d, int) { return d < 2 ? 0.0 : 1.0; };
  EXPECT_GT(hingeResidual(momentsOf(-6, 1, step), momentsOf(2, 9, step), 2.0), 1.0);
}

}  // namespace
}  // namespace fettle::engine
