#include "engine/measure/lines_apart.h"

#include <cstdlib>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/engine/measure/fields.h"

namespace fettle::engine {
namespace {

LinesApart apartBy(const Version& field, LineMethod method, ScanAxis axis = ScanAxis::kX) {
  LineOptions options;
  options.method = method;
  options.axis = axis;
  JobControl job;
  const auto offsets = findLineOffsets(field, options, job);
  EXPECT_TRUE(offsets);
  const auto apart = linesApart(field, *offsets, job);
  EXPECT_TRUE(apart);
  return *apart;
}

// Of each line: +1 and -1 by turns, a hole in some.
double stripe(int line, int place) {
  return place % 17 == 3 ? std::numeric_limits<double>::quiet_NaN() : line % 2 == 0 ? 1.0 : -1.0;
}

TEST(LinesApart, StripesAreHowFarLinesLieApartAndGoWithTheirOffsets) {
  for (const bool rows : {true, false}) {
    const Version field =
        fieldOf(90, 70, [&](int c, int r) { return 50.0 + (rows ? stripe(r, c) : stripe(c, r)); });
    const LinesApart apart = apartBy(field, LineMethod::kMedian, rows ? ScanAxis::kX : ScanAxis::kY);
    EXPECT_DOUBLE_EQ(apart.before, 2.0);
    EXPECT_NEAR(apart.after, 0.0, 1e-6);
    EXPECT_FALSE(apart.worse());
  }
}

// A plate of height 5 that takes a share of each line that changes: more than half of those in the middle.
TEST(LinesApart, APartOfTheSurfaceThatMovesLinesIsSeen) {
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0.0, 0.02);
  const Version field = fieldOf(120, 100, [&](int c, int r) {
    const bool plate = c < 40 + (r > 30 && r < 60 ? 40 : 0);
    return (plate ? 5.0 : 0.0) + noise(random);
  });
  EXPECT_TRUE(apartBy(field, LineMethod::kMedian).worse());
  EXPECT_FALSE(apartBy(field, LineMethod::kDifference).worse());
}

// A plate takes less than half of most lines and more than half of a block of 200, so that the medians of these lie 5 higher. Only two
// of 399 pairs of neighbours show it, which are little beside the noise of all; of pairs 16 apart 32 do.
TEST(LinesApart, ABlockOfLinesThatIsMovedIsSeenByLinesFartherApart) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.5);
  std::vector<double> values(std::size_t{120} * 400);
  for (double& value : values) value = noise(random);
  const Version field = fieldOf(120, 400, [&](int c, int r) {
    return (c < (r >= 100 && r < 300 ? 70 : 50) ? 5.0 : 0.0) + values[static_cast<std::size_t>(r) * 120 + c];
  });
  const LinesApart apart = apartBy(field, LineMethod::kMedian);
  EXPECT_TRUE(apart.worse());
  EXPECT_EQ(apart.lag, 16);
}

// The flanks of a slanted thread rise from line to line, all but its few falling ones: every difference is taken for the line's.
TEST(LinesApart, WhatAddsUpFromLineToLineIsSeenByLinesFartherApart) {
  const Version field = fieldOf(200, 300, [](int c, int r) { return 0.1 * ((c + r) % 10); });
  const LinesApart by_steps = apartBy(field, LineMethod::kDifference);
  EXPECT_TRUE(by_steps.worse());
  EXPECT_EQ(by_steps.lag, 16);
  EXPECT_FALSE(apartBy(field, LineMethod::kMedian).worse());
}

// Errors of medians of noise are no harm.
TEST(LinesApart, NoiseOfLevelLinesIsNotSaid) {
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0.0, 0.5);
  const Version field = fieldOf(64, 300, [&](int, int) { return noise(random); });
  for (const LineMethod method :
       {LineMethod::kMedian, LineMethod::kPolynomial, LineMethod::kDifference, LineMethod::kMatching})
    EXPECT_FALSE(apartBy(field, method).worse()) << static_cast<int>(method);
}

TEST(LinesApart, LevelLinesStaySoWhateverRoundingLeaves) {
  const Version field = fieldOf(64, 64, [](int c, int) { return 1000.0 + 0.1 * (c % 7); });
  for (const LineMethod method :
       {LineMethod::kMedian, LineMethod::kPolynomial, LineMethod::kDifference, LineMethod::kMatching})
    EXPECT_FALSE(apartBy(field, method).worse());
  const Version holes = fieldOf(
      20, 20, [](int c, int r) { return c == 3 && r == 3 ? 1.0 : std::numeric_limits<double>::quiet_NaN(); });
  EXPECT_FALSE(apartBy(holes, LineMethod::kMedian).worse());
}

}  // namespace
}  // namespace fettle::engine
