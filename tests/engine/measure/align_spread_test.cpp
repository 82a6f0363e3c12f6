// What residuals of an alignment are expected at level and at steep places.
#include "engine/measure/align_spread.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace fettle::engine {
namespace {

using Under = AlignLevel::Under;

constexpr double kNormalised = 1.4826;

// So many places of one slope, with residuals of both signs and of sizes about `middle`, which is their median.
void add(std::vector<Under>& under, int places, double slope, double middle) {
  for (int i = 0; i < places; ++i) {
    const double size = middle * (0.5 + static_cast<double>(i) / (places - 1));
    under.push_back({i % 2 == 0 ? size : -size, 0.6 * slope, -0.8 * slope, 0.0});
  }
}

TEST(AlignSpread, IsTheSizeOfLevelPlacesAndThatOfSteepOnes) {
  for (const double steep_size : {0.02, 0.05, 0.3}) {
    std::vector<Under> under;
    add(under, 2001, 0.0, 0.01);
    add(under, 101, 2.0, steep_size);
    under.push_back({});  // nothing lies under this one
    const AlignSpread spread = spreadOf(under, 1.0, 1e-6);
    EXPECT_NEAR(spread.level, kNormalised * 0.01, 0.03 * spread.level) << "one in twenty is steep";
    EXPECT_DOUBLE_EQ(spread.at(under.front()), spread.level);
    EXPECT_NEAR(spread.at(under[2001]), kNormalised * steep_size, 1e-12);
    // Half as steep they are half as far from that of level places, in squares a quarter.
    const double level = spread.level * spread.level;
    EXPECT_NEAR(std::pow(spread.at({0.0, 1.0, 0.0, 0.0}), 2) - level,
                0.25 * (std::pow(kNormalised * steep_size, 2) - level), 1e-12);
  }
}

TEST(AlignSpread, OfSteepPlacesThatAreFewOrAgreeIsThatOfTheLevelOnes) {
  for (const auto& [places, size] : {std::pair{23, 0.5}, {101, 0.0149}}) {
    std::vector<Under> under;
    add(under, 2001, 0.0, 0.01);
    add(under, places, 2.0, size);
    EXPECT_EQ(spreadOf(under, 1.0, 1e-6).sideways, 0.0) << places;
  }
}

TEST(AlignSpread, TakesTheLargestOfTheClassesOfSlopeUpToTheSpacing) {
  std::vector<Under> under;
  add(under, 4001, 0.0, 0.001);
  add(under, 51, 1.0, 0.01);
  add(under, 51, 20.0, 4.0);
  const AlignSpread two = spreadOf(under, 10.0, 1e-6);
  EXPECT_NEAR(two.at(under.back()), kNormalised * 4.0, 1e-9);
  EXPECT_EQ(spreadOf(under, 0.05, 1e-6).sideways, 0.05);
}

TEST(AlignSpread, OfFieldsThatAgreeIsTheLeastThatIsAllowed) {
  std::vector<Under> under;
  add(under, 100, 0.0, 0.0);
  EXPECT_EQ(spreadOf(under, 1.0, 1e-5).level, 1e-5);
  EXPECT_EQ(spreadOf({}, 1.0, 1e-5).level, 1e-5);
  EXPECT_EQ(residualAt({}, 0.5), 0.0);
  add(under, 101, 0.0, 2.0);
  EXPECT_NEAR(residualAt(under, 1.0), 3.0, 1e-12);
}

}  // namespace
}  // namespace fettle::engine
