#include "engine/measure/material_ratio.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace fettle::engine {
namespace {

// n heights whose k-th from the top is `height` at the middle of its share.
template <class F>
std::vector<float> curveOf(int n, const F& height) {
  std::vector<float> sorted(static_cast<std::size_t>(n));
  for (int k = 0; k < n; ++k)
    sorted[static_cast<std::size_t>(n - 1 - k)] = static_cast<float>(height((k + 0.5) / n));
  return sorted;
}

// A straight curve has neither peaks nor dales; volumes are triangles.
TEST(MaterialRatio, OfAStraightCurveIsAllCore) {
  const std::vector<float> sorted = curveOf(100000, [](double q) { return 3.0 * (0.5 - q); });
  const MaterialRatio ratio = materialRatio(sorted);
  EXPECT_NEAR(ratio.sk, 3.0, 1e-5);
  EXPECT_NEAR(ratio.spk, 0.0, 1e-5);
  EXPECT_NEAR(ratio.svk, 0.0, 1e-5);
  EXPECT_NEAR(ratio.smrk1, 0.0, 1e-4);
  EXPECT_NEAR(ratio.smrk2, 1.0, 1e-4);
  EXPECT_NEAR(ratio.vmp, 3.0 * 0.1 * 0.1 / 2, 1e-5);
  EXPECT_NEAR(ratio.vmc, 3.0 * (0.8 * 0.8 - 0.1 * 0.1) / 2, 1e-5);
  EXPECT_NEAR(ratio.vvc, 3.0 * (0.9 * 0.9 - 0.2 * 0.2) / 2, 1e-5);
  EXPECT_NEAR(ratio.vvv, 3.0 * 0.2 * 0.2 / 2, 1e-5);
  EXPECT_NEAR(ratio.sxp, 3.0 * 0.475, 1e-5);
}

// Of a ramp from 3 to 0, z = 3 (1 - q): Vm(p) = 3 p^2 / 2, Vv(p) = 3 (1 - p)^2 / 2; of a sine of amplitude A, z = A cos(pi q) by its share,
// Vm(p) = A (sin(pi p) / pi - p cos(pi p)), and Vv(p) more by the height of p, since the mean is 0.
TEST(MaterialRatio, VolumesAtAnyRatioAreThoseOfARampAndOfASine) {
  using std::numbers::pi;
  const auto ramp = curveOf(100000, [](double q) { return 3.0 * (1.0 - q); });
  const auto sine = curveOf(100000, [](double q) { return 2.0 * std::cos(pi * q); });
  for (const double p : {0.02, 0.1, 0.5, 0.8, 0.95}) {
    EXPECT_NEAR(materialVolume(ramp, p), 1.5 * p * p, 1e-5) << p;
    EXPECT_NEAR(voidVolume(ramp, p), 1.5 * (1.0 - p) * (1.0 - p), 1e-5) << p;
    const double above = 2.0 * (std::sin(pi * p) / pi - p * std::cos(pi * p));
    EXPECT_NEAR(materialVolume(sine, p), above, 1e-5) << p;
    EXPECT_NEAR(voidVolume(sine, p), above + 2.0 * std::cos(pi * p), 1e-5) << p;
    EXPECT_NEAR(heightAtRatio(sine, p), 2.0 * std::cos(pi * p), 1e-4) << p;
  }
  // Peaks end at 25 %, dales begin at 60 %.
  const MaterialRatio ratio = materialRatio(ramp, {0.25, 0.6});
  EXPECT_NEAR(ratio.vmp, 1.5 * 0.25 * 0.25, 1e-5);
  EXPECT_NEAR(ratio.vmc, 1.5 * (0.6 * 0.6 - 0.25 * 0.25), 1e-5);
  EXPECT_NEAR(ratio.vvc, 1.5 * (0.75 * 0.75 - 0.4 * 0.4), 1e-5);
  EXPECT_NEAR(ratio.vvv, 1.5 * 0.4 * 0.4, 1e-5);
}

// Core of height 1 from 20 to 70 %, peaks and dales straight and steeper: ISO 13565-2's triangles.
TEST(MaterialRatio, OfThreeStraightPiecesHasTheirTriangles) {
  const auto height = [](double q) {
    if (q < 0.2) return 0.5 + 10.0 * (0.2 - q);
    if (q > 0.7) return -0.5 - 4.0 * (q - 0.7);
    return 0.5 - (q - 0.2) / 0.5;
  };
  const MaterialRatio ratio = materialRatio(curveOf(200000, height));
  // The core's line, slope -2 through 0.5 at 20 %: 0.9 at 0 and -1.1 at 100 %.
  EXPECT_NEAR(ratio.sk, 2.0, 1e-4);
  const double smrk1 = 0.2 - 0.4 / 10.0, smrk2 = 0.7 + 0.6 / 4.0;
  EXPECT_NEAR(ratio.smrk1, smrk1, 1e-4);
  EXPECT_NEAR(ratio.smrk2, smrk2, 1e-4);
  EXPECT_NEAR(ratio.spk, 10.0 * smrk1, 1e-3);         // a triangle as it is
  EXPECT_NEAR(ratio.svk, 4.0 * (1.0 - smrk2), 1e-3);  // likewise
}

// A curve that bends everywhere, by Gauss's error function: Spk and Svk agree, Sk is near 0.4 of the secant's slope.
TEST(MaterialRatio, OfASymmetricCurveIsSymmetric) {
  const MaterialRatio ratio =
      materialRatio(curveOf(100001, [](double q) { return std::pow(1.0 - 2.0 * q, 3.0); }));
  EXPECT_NEAR(ratio.spk, ratio.svk, 1e-4);
  EXPECT_NEAR(ratio.smrk1, 1.0 - ratio.smrk2, 1e-4);
  // Least squares of t^3 by s t over -0.4 .. 0.4: s = 3 / 5 0.4^2, of t = 1 - 2 q.
  EXPECT_NEAR(ratio.sk, 2.0 * 0.6 * 0.16, 1e-4);
  const double top = 0.6 * 0.16, t = std::cbrt(top);
  EXPECT_NEAR(ratio.smrk1, (1.0 - t) / 2.0, 1e-4);
  const double area = 0.5 * ((1.0 - std::pow(t, 4.0)) / 4.0 - top * (1.0 - t));
  EXPECT_NEAR(ratio.spk, 2.0 * area / ratio.smrk1, 1e-4);
}

TEST(MaterialRatio, OfOneOrEqualHeightsIsZero) {
  for (const std::size_t n : {std::size_t{1}, std::size_t{2}, std::size_t{1000}}) {
    const MaterialRatio ratio = materialRatio(std::vector<float>(n, 7.25F));
    EXPECT_EQ(ratio.sk, 0.0);
    EXPECT_TRUE(std::isnan(ratio.smrk1) && std::isnan(ratio.smrk2)) << "where a core without a height ends";
    EXPECT_EQ(ratio.spk, 0.0);
    EXPECT_EQ(ratio.svk, 0.0);
    EXPECT_EQ(ratio.vmp, 0.0);
    EXPECT_EQ(ratio.vvc, 0.0);
    EXPECT_EQ(ratio.sxp, 0.0);
  }
}

}  // namespace
}  // namespace fettle::engine
