#include "engine/measure/probe.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"

namespace fettle::engine {
namespace {

Version probedField(const std::function<double(double, double)>& z) {
  Grid grid;
  grid.width = 81;
  grid.height = 61;
  grid.spacing_x = 0.1;
  grid.spacing_y = 0.2;
  std::vector<float> heights;
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) heights.push_back(static_cast<float>(z(c * 0.1, r * 0.2)));
  return makeField(grid, heights);
}

TEST(Probe, OfAQuadraticIsTheQuadratic) {
  const Version field = probedField([](double x, double y) {
    return 0.5 + 0.3 * (x - 4.0) + 0.05 * (x - 4.0) * (x - 4.0) - 0.02 * (y - 6.0) * (y - 6.0);
  });
  const auto p = probeAt(field, {4.0, 6.0}, 1.0, Region::kAll, {0.0});
  ASSERT_TRUE(p) << p.error().line();
  EXPECT_NEAR(p->height_mm.value, 0.5, 1e-7);
  EXPECT_NEAR(p->slope_deg.value, std::atan(0.3) * 180.0 / 3.14159265358979, 1e-4);
  EXPECT_NEAR(p->rises_to_deg, 0.0, 1e-4);
  // Along x 2 a / w^3, along y 2 b / w, w^2 = 1 + 0.3^2.
  const double w = std::sqrt(1.09);
  EXPECT_NEAR(p->most_curvature, 0.1 / (w * w * w), 1e-5);
  EXPECT_NEAR(p->least_curvature, -0.04 / w, 1e-5);
  EXPECT_NEAR(p->mean_curvature.value, 0.5 * (0.1 / (w * w * w) - 0.04 / w), 1e-5);
}

// Figures of 1,000 scans of noise: the stated errors are those that they have, within their own scatter of 2.2 % (1 sd).
TEST(Probe, StatedErrorsAreThoseOfTheNoise) {
  double height = 0.0, curvature = 0.0, slope = 0.0;
  ProbeFigures last;
  for (int seed = 0; seed < 1000; ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed) + 1);
    std::normal_distribution<double> normal(0.0, 0.001);
    const Version field = probedField([&](double x, double) { return 0.2 * x + normal(random); });
    const auto p = probeAt(field, {4.03, 6.11}, 1.0, Region::kAll, {0.001});
    ASSERT_TRUE(p) << p.error().line();
    height += std::pow(p->height_mm.value - 0.2 * 4.03, 2) / 1000.0;
    slope += std::pow(p->slope_deg.value - std::atan(0.2) * 180.0 / 3.14159265358979, 2) / 1000.0;
    curvature += std::pow(p->mean_curvature.value, 2) / 1000.0;
    last = *p;
  }
  EXPECT_NEAR(std::sqrt(height) / last.height_mm.error, 1.0, 0.1);
  EXPECT_NEAR(std::sqrt(slope) / last.slope_deg.error, 1.0, 0.1);
  EXPECT_NEAR(std::sqrt(curvature) / last.mean_curvature.error, 1.0, 0.1);
}

// The same of scans whose rows, or columns, are off by ten times the noise of a sample: a quadratic follows the offsets of the few lines
// in its radius, and what they leave is no noise of samples.
TEST(Probe, StatedErrorsCountRowsAndColumnsThatAreOff) {
  constexpr double kOff = 0.01, kSample = 0.001;
  for (const bool by_rows : {true, false}) {
    double height = 0.0, curvature = 0.0, slope = 0.0, heights = 0.0, curvatures = 0.0, slopes = 0.0;
    for (int seed = 0; seed < 400; ++seed) {
      std::mt19937_64 random(static_cast<std::uint64_t>(seed) + 1);
      std::normal_distribution<double> normal;
      std::vector<double> off(81);
      for (double& each : off) each = kOff * normal(random);
      const Version field = probedField([&](double x, double y) {
        return 0.2 * x + 0.2 * y + off[static_cast<std::size_t>(std::lround(by_rows ? y / 0.2 : x / 0.1))] +
               kSample * normal(random);
      });
      const auto p = probeAt(field, {4.03, 6.11}, 1.0, Region::kAll,
                             {kSample, by_rows ? kOff : 0.0, by_rows ? 0.0 : kOff});
      ASSERT_TRUE(p) << p.error().line();
      height += std::pow(p->height_mm.value - 0.2 * (4.03 + 6.11), 2);
      slope += std::pow(p->slope_deg.value - std::atan(std::hypot(0.2, 0.2)) * 180.0 / 3.14159265358979, 2);
      curvature += std::pow(p->mean_curvature.value, 2);
      heights += std::pow(p->height_mm.error, 2);
      slopes += std::pow(p->slope_deg.error, 2);
      curvatures += std::pow(p->mean_curvature.error, 2);
    }
    // The root of a mean square of 400 is known to 3.5 %.
    EXPECT_NEAR(std::sqrt(height / heights), 1.0, 0.12) << by_rows;
    EXPECT_NEAR(std::sqrt(slope / slopes), 1.0, 0.12) << by_rows;
    EXPECT_NEAR(std::sqrt(curvature / curvatures), 1.0, 0.12) << by_rows;
  }
}

// Rows that are off say how much more than the noise of samples may be left, and no more than that: noise three times as large as
// stated is seen beside them.
TEST(Probe, MoreNoiseThanStatedIsSeenBesideRowsThatAreOff) {
  constexpr double kOff = 0.01, kSample = 0.03;
  double stated = 0.0, seen = 0.0;
  for (int seed = 0; seed < 40; ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed) + 1);
    std::normal_distribution<double> normal;
    std::vector<double> off(61);
    for (double& each : off) each = kOff * normal(random);
    const Version field = probedField([&](double, double y) {
      return off[static_cast<std::size_t>(std::lround(y / 0.2))] + kSample * normal(random);
    });
    const auto error = [&](double sample_mm) {
      const auto p = probeAt(field, {4.03, 6.11}, 2.0, Region::kAll, {sample_mm, kOff, 0.0});
      EXPECT_TRUE(p) << p.error().line();
      return p ? p->height_mm.error : 0.0;
    };
    stated += error(kSample) / 40.0;
    seen += error(kSample / 3.0) / 40.0;
  }
  // The mean of 40 roots of a variance that each is known to 5 %, of about 150 samples.
  EXPECT_NEAR(seen / stated, 1.0, 0.1);
}

// At every border and beyond: by the samples within the radius that there are.
TEST(Probe, AtABorderIsByTheSamplesThereAre) {
  const auto z = [](double x, double y) { return 0.1 * x * x - 0.05 * x * y + 0.2 * y; };
  const Version field = probedField(z);
  for (const double x : {-0.25, 0.05, 4.02, 7.97, 8.25})
    for (const double y : {-0.35, 0.1, 6.05, 11.93, 12.35}) {
      int inside = 0;
      for (int r = 0; r < 61; ++r)
        for (int c = 0; c < 81; ++c) inside += std::hypot(c * 0.1 - x, r * 0.2 - y) <= 1.0 ? 1 : 0;
      const auto p = probeAt(field, {x, y}, 1.0, Region::kAll, {0.0});
      ASSERT_TRUE(p) << p.error().line();
      EXPECT_EQ(p->samples, inside) << x << ' ' << y;
      EXPECT_NEAR(p->height_mm.value, z(x, y), 1e-5) << x << ' ' << y;
    }
}

// Half of the samples around a place on the right border are there: those say less about the slope across it.
TEST(Probe, StatesTheErrorOfTheSlopeInItsDirection) {
  const auto error = [](double along_x, double along_y) {
    const Version field = probedField([&](double x, double y) { return along_x * x + along_y * y; });
    const auto p = probeAt(field, {8.0, 6.0}, 1.0, Region::kAll, {0.001});
    EXPECT_TRUE(p) << p.error().line();
    return p ? p->slope_deg.error : 0.0;
  };
  EXPECT_GT(error(0.1, 0.0), 2.0 * error(0.0, 0.1));
}

TEST(Probe, RefusesWhatShowsNoSurface) {
  const Version field = probedField([](double x, double) { return x; });
  EXPECT_FALSE(probeAt(field, {4.0, 6.0}, 0.05, Region::kAll, {0.0}));
  EXPECT_FALSE(probeAt(field, {4.0, 6.0}, 0.15, Region::kAll, {0.0}));
  EXPECT_FALSE(probeAt(field, {400.0, 6.0}, 1.0, Region::kAll, {0.0}));
  EXPECT_FALSE(probeAt(field, {std::nan(""), 6.0}, 1.0, Region::kAll, {0.0}));
  EXPECT_FALSE(probeAt(field, {4.0, 6.0}, 1e9, Region::kAll, {0.0}));
  const Version holes = probedField([](double, double) { return std::numeric_limits<double>::quiet_NaN(); });
  EXPECT_FALSE(probeAt(holes, {4.0, 6.0}, 1.0, Region::kAll, {0.0}));
  // Without samples because of holes, or because it lies beside the scan: up to its first and last samples it is in it.
  for (const double x : {-0.1, 0.0, 0.3, 7.7, 8.0, 8.1})
    for (const double y : {-0.1, 0.0, 0.3, 11.7, 12.0, 12.1}) {
      const auto none = probeAt(holes, {x, y}, 1.0, Region::kAll, {0.0});
      ASSERT_FALSE(none);
      const bool in = x >= 0.0 && x <= 8.0 && y >= 0.0 && y <= 12.0;
      EXPECT_EQ(none.error().line().find("outside of the scan") == std::string::npos, in) << x << ' ' << y;
    }
}

}  // namespace
}  // namespace fettle::engine
