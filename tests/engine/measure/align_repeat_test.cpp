// Surfaces that repeat themselves fit at every period, and an alignment says so.

#include "engine/measure/align_repeat.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "engine/field/builder.h"
#include "engine/measure/align.h"

namespace fettle::engine {
namespace {

using std::numbers::pi;

using RepeatShape = std::function<double(double x, double y)>;

constexpr double kPeriod = 2.5;  // [mm]
constexpr double kNoiseMm = 0.004;

// A shape that lies `shift` further than another scan of it [mm], with noise of its own; samples 0.1 mm apart.
Version scanOf(std::int32_t width, std::int32_t height, const RepeatShape& shape, const glm::dvec2& shift,
               std::uint64_t seed) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  grid.spacing_x = grid.spacing_y = 0.1;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, kNoiseMm);
  std::vector<float> heights;
  std::vector<std::uint8_t> marks;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) {
      heights.push_back(static_cast<float>(shape(0.1 * c - shift.x, 0.1 * r - shift.y) + normal(random)));
      marks.push_back(c >= width / 2 ? 1 : 0);
    }
  return makeField(grid, heights, marks);
}

double grid(double x, double y) {
  return 0.03 * (std::sin(2.0 * pi * x / kPeriod) + std::sin(2.0 * pi * y / kPeriod));
}
// Squares with flat tops, on a bow that a tilt makes up for.
double bowedPads(double x, double y) {
  const auto pad = [](double v) { return 1.0 / (1.0 + std::exp(-8.0 * std::sin(2.0 * pi * v / kPeriod))); };
  return 0.1 * pad(x) * pad(y) + 0.0005 * ((x - 8.0) * (x - 8.0) + (y - 8.0) * (y - 8.0));
}
// Printed lines a tenth of a millimetre high, crossed by waves of another length.
double rows(double x, double y) {
  return 0.02 * std::sin(2.0 * pi * (x + 0.3 * y) / 1.1) + 0.02 * std::sin(2.0 * pi * (y - 0.3 * x) / 3.1);
}
double hills(double x, double y) {
  return 0.1 * std::sin(0.9 * x + 0.3) * std::cos(0.7 * y) + 0.06 * std::sin(1.7 * x - 1.3 * y + 1.0) +
         0.04 * std::cos(2.9 * y + 0.4 * x * x / 10.0) + 0.03 * std::sin(3.1 * x + 0.2 * y * y / 7.0);
}
double gridWithBoss(double x, double y) {
  const double u = x - 4.1, v = y - 6.3;
  return grid(x, y) + 0.05 * std::exp(-(u * u + v * v) / 0.3);
}
// Squares whose heights differ by a tenth from one to the next, in no order.
double unlikeSquares(double x, double y) {
  const double column = std::floor(x / kPeriod), row = std::floor(y / kPeriod);
  return grid(x, y) * (1.0 + 0.1 * std::sin(12.9898 * column * column + 78.233 * row * (row + column) + 0.7));
}
double roughness(double x, double y) {
  double sum = 0.0;
  for (int k = 0; k < 40; ++k) {
    const double turn = 2.399963 * k, length = 0.9 + 4.0 * std::fmod(0.618034 * k, 1.0);
    sum += 0.01 * std::sin(2.0 * pi * (x * std::cos(turn) + y * std::sin(turn)) / length + 1.7 * k * k);
  }
  return sum;
}

Result<Alignment> alignedScans(const RepeatShape& shape, const AlignOptions& options, std::uint64_t seed,
                               std::int32_t side = 160) {
  JobControl job;
  return alignFields(scanOf(side, side, shape, {0.37, -0.21}, seed),
                     scanOf(side, side - 8, shape, {}, seed + 1000), options, job);
}

TEST(AlignRepeat, ASurfaceThatRepeatsItselfIsSaidToFitAPeriodFurther) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed)
    for (const auto& [shape, period] :
         {std::pair<RepeatShape, double>{grid, kPeriod}, {bowedPads, kPeriod}}) {
      const auto found = alignedScans(shape, {}, seed);
      ASSERT_TRUE(found) << found.error().line();
      ASSERT_TRUE(found->repeat) << period << ' ' << seed;
      EXPECT_NEAR(glm::length(*found->repeat), period, 0.02);
      // What was found is right but for whole periods.
      const glm::dvec2 off = (glm::dvec2(found->motion.shift) - glm::dvec2(0.37, -0.21)) / kPeriod;
      EXPECT_NEAR(off.x, std::round(off.x), 0.01);
      EXPECT_NEAR(off.y, std::round(off.y), 0.01);
    }
}

// Along no row of samples, and with a pattern that only both waves together repeat: its shortest shift is no wave's length.
TEST(AlignRepeat, TheShortestShiftIsThatOfBothWaves) {
  const auto found = alignedScans(rows, {}, 5);
  ASSERT_TRUE(found) << found.error().line();
  ASSERT_TRUE(found->repeat);
  const glm::dvec2 shift = *found->repeat;
  const double first = (shift.x + 0.3 * shift.y) / 1.1, second = (shift.y - 0.3 * shift.x) / 3.1;
  EXPECT_NEAR(first, std::round(first), 0.02);
  EXPECT_NEAR(second, std::round(second), 0.02);
  EXPECT_LT(glm::length(shift), 1.2);
}

TEST(AlignRepeat, ASurfaceOfWhichSomethingOccursOnceIsNot) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed)
    for (const RepeatShape& shape : {RepeatShape(hills), RepeatShape(gridWithBoss),
                                     RepeatShape(unlikeSquares), RepeatShape(roughness)}) {
      const auto found = alignedScans(shape, {}, seed);
      ASSERT_TRUE(found) << found.error().line();
      EXPECT_FALSE(found->repeat) << glm::length(*found->repeat) << ' ' << seed;
      EXPECT_NEAR(found->motion.shift.x, 0.37, 0.02);
      EXPECT_NEAR(found->motion.shift.y, -0.21, 0.02);
    }
}

// By a region without what occurs once; and by one period alone, which the other scan has many times.
TEST(AlignRepeat, ARegionWithoutWhatOccursOnceIsAtEveryPeriod) {
  const RepeatShape shape = gridWithBoss;
  AlignOptions right;
  right.region = Region::kMarked;  // the boss is in the left half
  const auto found = alignedScans(shape, right, 7);
  ASSERT_TRUE(found) << found.error().line();
  ASSERT_TRUE(found->repeat);
  EXPECT_NEAR(glm::length(*found->repeat), kPeriod, 0.02);
  JobControl job;
  const auto small = alignFields(scanOf(40, 40, grid, {0.1, 0.2}, 8), scanOf(160, 160, grid, {}, 9), {}, job);
  ASSERT_TRUE(small) << small.error().line();
  ASSERT_TRUE(small->repeat);
  EXPECT_NEAR(glm::length(*small->repeat), kPeriod, 0.1);
}

// What is not searched is stated: no other place comes into question.
TEST(AlignRepeat, NotWhereTheShiftIsStated) {
  AlignOptions stated;
  stated.search = false;
  const auto found = alignedScans(grid, stated, 3);
  ASSERT_TRUE(found) << found.error().line();
  EXPECT_FALSE(found->repeat);
}

}  // namespace
}  // namespace fettle::engine
