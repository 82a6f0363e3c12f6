#include "engine/scanner/laser_effects.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "engine/scanner/scanner.h"

namespace fettle::engine {
namespace {

ScanBlock flatBlock(int columns, int rows) {
  ScanBlock block;
  block.column = 100;
  block.row = 40;
  block.columns = columns;
  block.rows = rows;
  block.height.fill(0.0);
  return block;
}

TEST(LateralSpot, AWallBecomesTheIntegralOfTheSpot) {
  for (const double spot : {0.5, 1.0, 2.0})
    for (const double wall : {120.0, 120.3, 120.77}) {
      ScanBlock block = flatBlock(64, 9);
      averageUnderSpot(block, spot, [&](double column, double) { return column < wall ? 0.0 : 2.0; });
      // Places are exact to half a fine sample, where the profile is steepest; beyond three deviations nothing counts.
      const double steepest = 2.0 / (spot * std::sqrt(2.0 * 3.14159265358979));
      for (int c = 0; c < block.columns; ++c) {
        const double exact = 1.0 + std::erf((100 + c - wall) / (spot * std::sqrt(2.0)));
        EXPECT_NEAR(block.heightAt(c, 4), exact, 0.5 / kSpotFineness * steepest + 0.006) << spot << ' ' << c;
        EXPECT_EQ(block.heightAt(c, 0), block.heightAt(c, 8));
      }
    }
}

TEST(LateralSpot, PlanesStayAndThroughHolesStayHoles) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  ScanBlock block = flatBlock(40, 64);
  block.heightAt(7, 9) = kNan;
  averageUnderSpot(block, 1.5, [](double column, double row) { return 0.25 * column - 0.5 * row + 3.0; });
  for (int r = 0; r < block.rows; ++r)
    for (int c = 0; c < block.columns; ++c) {
      if (c == 7 && r == 9)
        EXPECT_TRUE(std::isnan(block.heightAt(c, r)));
      else
        EXPECT_NEAR(block.heightAt(c, r), 0.25 * (100 + c) - 0.5 * (40 + r) + 3.0, 1e-9);
    }
  // Next to a hole only the surface counts.
  ScanBlock rim = flatBlock(20, 20);
  averageUnderSpot(rim, 1.0, [&](double column, double) { return column < 110.0 ? 5.0 : kNan; });
  for (int c = 0; c < 10; ++c) EXPECT_NEAR(rim.heightAt(c, 10), 5.0, 1e-12);
}

TEST(LateralSpot, BlursTheScanOfAPartAndNotItsTruth) {
  JobControl job;
  ScannerSpec spec;
  spec.part = "steps";
  spec.width = 150, spec.height = 140;  // more than one tile
  spec.noise = 0.0;
  const auto sharp = simulateScan(spec, job);
  spec.spot = 1.0;
  const auto blurred = simulateScan(spec, job), again = simulateScan(spec, job);
  ASSERT_TRUE(sharp && blurred && again);
  EXPECT_EQ(contentHash(blurred->truth), contentHash(sharp->truth));
  EXPECT_EQ(contentHash(blurred->scan), contentHash(again->scan));
  double worst = 0.0, steepest_sharp = 0.0, steepest = 0.0;
  std::int64_t changed = 0;
  for (int r = 0; r < 140; ++r)
    for (int c = 0; c < 149; ++c) {
      const auto at = [&](const Version& v, int column) { return double{v.reader().heightAt(column, r)}; };
      worst = std::max(worst, std::abs(at(blurred->scan, c) - at(sharp->scan, c)));
      changed += std::abs(at(blurred->scan, c) - at(sharp->scan, c)) > 0.01;
      steepest_sharp = std::max(steepest_sharp, std::abs(at(sharp->scan, c + 1) - at(sharp->scan, c)));
      steepest = std::max(steepest, std::abs(at(blurred->scan, c + 1) - at(blurred->scan, c)));
    }
  EXPECT_GT(changed, 500);
  EXPECT_LT(changed, 140 * 149 * 2 / 3);      // flats stay
  EXPECT_LT(steepest, 0.5 * steepest_sharp);  // a wall's steepest sample is 0.38 of it
  EXPECT_GT(worst, 0.2 * steepest_sharp);
  spec.spot = 4.1;
  EXPECT_FALSE(simulateScan(spec, job));
}

}  // namespace
}  // namespace fettle::engine
