#include "engine/inspect/height_counts.h"

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "tests/engine/inspect/grids.h"

namespace fettle::engine {
namespace {

constexpr int kCountsSide = 200;

// Noise of two counts on a slope.
Version counted(const std::function<double(double)>& height) {
  std::mt19937_64 random(7);
  std::vector<float> z;
  for (int i = 0; i < kCountsSide * kCountsSide; ++i) {
    const double noise = static_cast<double>(random() >> 11) * 0x1p-53 * 8.0;
    z.push_back(static_cast<float>(height(noise + 0.01 * (i % kCountsSide))));
  }
  return makeField(gridOf(kCountsSide, kCountsSide), z);
}

TEST(HeightCounts, AreFoundWithTheirStepAndOffset) {
  for (const double step : {0.01, 3e-7, 250.0})
    for (const double first : {0.0, 0.37 * step, 1000.0 * step}) {
      const HeightCounts counts =
          findHeightCounts(counted([&](double z) { return first + step * std::nearbyint(z); }));
      EXPECT_NEAR(counts.step, step, 1e-4 * step) << step << " from " << first;
      EXPECT_NEAR(std::remainder(counts.first - first, step), 0.0, 1e-3 * step);
      EXPECT_NEAR(counts.nearest(first + 5.3 * step), first + 5.0 * step, 2e-3 * step);
    }
}

TEST(HeightCounts, AreNoneInHeightsOfAnySize) {
  const HeightCounts none = findHeightCounts(counted([](double z) { return 0.01 * z; }));
  EXPECT_EQ(none.step, 0.0);
  EXPECT_EQ(none.nearest(0.123), 0.123);
}

TEST(HeightCounts, AreNotTheRoundingOfFloat) {
  EXPECT_EQ(findHeightCounts(counted([](double z) { return 5e6 + 0.1 * z; })).step, 0.0);
}

TEST(HeightCounts, AreNoneWithoutTwoHeights) {
  const auto field = [](float z) {
    return findHeightCounts(makeField(gridOf(30, 1), std::vector<float>(30, z))).step;
  };
  EXPECT_EQ(field(1.0F), 0.0);
  EXPECT_EQ(field(std::numeric_limits<float>::quiet_NaN()), 0.0);
  EXPECT_EQ(field(std::numeric_limits<float>::denorm_min()), 0.0);
}

}  // namespace
}  // namespace fettle::engine
