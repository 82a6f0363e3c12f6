// What an opening cannot do without is counted rightly where it is known.
#include "bench/rolled_work.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"

namespace fettle::bench {
namespace {

using engine::FilterKind;

engine::Version ground(std::int32_t side, const std::function<double(int, int)>& height) {
  engine::Grid grid;
  grid.width = grid.height = side;
  grid.spacing_x = grid.spacing_y = 1.0;
  auto builder = engine::FieldBuilder::create(grid, "the ground");
  std::vector<float> row(static_cast<std::size_t>(side));
  for (std::int32_t r = 0; r < side; ++r) {
    for (std::int32_t c = 0; c < side; ++c)
      row[static_cast<std::size_t>(c)] = static_cast<float>(height(c, r));
    builder->writeHeights(0, r, side, 1, row.data(), side);
  }
  return std::move(*builder).build();
}

engine::FilterSpec rolled(double radius, FilterKind kind = FilterKind::kOpening) {
  engine::FilterSpec spec;
  spec.kind = kind;
  spec.nesting_mm = radius;
  return spec;
}

double rough(int c, int r) {
  return std::sin(12.9898 * c + 78.233 * r + 0.01 * c * r);
}

constexpr double kOfGroups = (16.0 + 1.0) / 256.0;  // one large group within reach, and its small ones

TEST(RolledWork, OfADiskHasAChordForEachOfItsRowsTwice) {
  engine::Grid grid;
  grid.width = grid.height = 64;
  grid.spacing_x = grid.spacing_y = 1.0;
  EXPECT_EQ(chordsOfDisk(rolled(3.0), grid), 14);
  grid.spacing_y = 0.5;
  EXPECT_EQ(chordsOfDisk(rolled(3.0), grid), 26);
}

TEST(RolledWork, OfABallHasAQuartersPairsAndItsDifferentDistances) {
  const engine::Version high = ground(64, [](int c, int) { return 100.0 * c; });
  const BallPairs one = pairsOfBall(high, rolled(1.0));
  EXPECT_EQ(one.pairs, 3);
  EXPECT_EQ(one.depths, 2);
  // Squares of distances 0, 1, 2, 4, 5, 8, 9, 10, 13, 16, 17, 18, 20, 25.
  const BallPairs five = pairsOfBall(high, rolled(5.0));
  EXPECT_EQ(five.pairs, 26);
  EXPECT_EQ(five.depths, 14);
}

TEST(RolledWork, OnAFlatEverySampleIsTouchedFromItself) {
  for (const BallTouches& each : touchesOfBall(ground(64, [](int, int) { return 2.0; }), rolled(5.0))) {
    EXPECT_DOUBLE_EQ(each.sums, 32.0);
    EXPECT_DOUBLE_EQ(each.tests, 1.0 + kOfGroups);
  }
}

TEST(RolledWork, AHoleHasNoResultAndIsNotTouched) {
  const engine::Version half =
      ground(16, [](int c, int) { return c < 8 ? std::numeric_limits<double>::quiet_NaN() : 2.0; });
  for (const BallTouches& each : touchesOfBall(half, rolled(5.0))) {
    EXPECT_DOUBLE_EQ(each.sums, 16.0);
    EXPECT_DOUBLE_EQ(each.tests, 0.5 + kOfGroups);
  }
}

TEST(RolledWork, APitDeeperThanTheBallIsAllThatIsTouched) {
  const engine::Version pit = ground(16, [](int c, int r) { return c == 8 && r == 8 ? -100.0 : 0.0; });
  const BallTouches first = touchesOfBall(pit, rolled(40.0))[0];
  EXPECT_DOUBLE_EQ(first.sums, 1.0);
  EXPECT_DOUBLE_EQ(first.tests, 0.5 + kOfGroups);
}

TEST(RolledWork, IsTheSameForTheClosingOfWhatIsTurnedOver) {
  const engine::Version field = ground(80, rough),
                        turned = ground(80, [](int c, int r) { return -rough(c, r); });
  const auto opening = touchesOfBall(field, rolled(9.0));
  const auto closing = touchesOfBall(turned, rolled(9.0, FilterKind::kClosing));
  const auto inverted = touchesOfBall(field.inverted(), rolled(9.0));
  const auto other = touchesOfBall(field, rolled(9.0, FilterKind::kClosing));
  EXPECT_NE(opening[0].sums, other[0].sums);
  for (const std::size_t erosion : {0U, 1U}) {
    EXPECT_EQ(opening[erosion].sums, closing[erosion].sums);
    EXPECT_EQ(opening[erosion].tests, closing[erosion].tests);
    EXPECT_EQ(opening[erosion].sums, inverted[erosion].sums);
    EXPECT_EQ(opening[erosion].tests, inverted[erosion].tests);
  }
}

}  // namespace
}  // namespace fettle::bench
