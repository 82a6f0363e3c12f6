#include "engine/edges/across.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "tests/engine/edges/edge_fields.h"

namespace fettle::engine {
namespace {

struct Division {
  std::vector<float> costs;
  std::vector<Extent> extents;
  double best = 0.0;  // offset

  Division(const std::function<double(int)>& z, const std::vector<double>& breaks, std::size_t own,
           double noise, std::uint64_t seed = 1, CpuLevel level = bestCpuLevel()) {
    AcrossSearch::Model model;
    model.offsets.reach = 4.0;
    model.variance = 1.3 * noise * noise;
    AcrossSearch search(model, level);
    search.clear();
    for (int d = -12; d <= 12; ++d)
      for (int s = -4; s <= 4; ++s)
        search.add({0, static_cast<double>(d), 0.0, z(d) + noise * whiteNoise(d, s, seed)}, s);
    costs.resize(static_cast<std::size_t>(model.offsets.count()));
    extents.resize(costs.size());
    search.solve(breaks, own, costs, extents);
    const auto least = std::min_element(costs.begin(), costs.end()) - costs.begin();
    best = model.offsets.at(static_cast<int>(least));
  }
};

// A step between samples d and d + 1 is found at one of the offsets between them: they differ by the pull
// towards 0 alone.
TEST(AcrossSearch, FindsAStepOfTwoDeviationsBetweenItsSamples) {
  int right = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Division found([](int d) { return d < -1 ? 0.2 * d : 0.2 * d + 2.0; }, {0.0}, 0, 1.0, seed);
    right += found.best >= -2.0 && found.best <= -0.75 ? 1 : 0;
  }
  EXPECT_GE(right, 18);
}

TEST(AcrossSearch, FindsACrease) {
  const Division found([](int d) { return d < 2 ? 0.0 : 0.5 * (d - 2); }, {0.0}, 0, 0.1);
  // Without noise two planes fit as well as the hinge, with a break anywhere between the samples next to it.
  EXPECT_GE(found.best, 1.0);
  EXPECT_LE(found.best, 3.0);
}

TEST(AcrossSearch, OnAFlatTheHandDecides) {
  const Division found([](int) { return 5.0; }, {0.0}, 0, 1.0);
  EXPECT_LE(std::abs(found.best), 3.0);
  // All that a break can gain from noise is less than a free break costs.
  const auto [least, most] = std::minmax_element(found.costs.begin(), found.costs.end());
  EXPECT_LT(*most - *least, 30.0F);
}

TEST(AcrossSearch, NeighbouringBreaksKeepTheirOrder) {
  // A rib 3 samples wide with a hand on each side: each finds its own wall, also from on top of the other.
  const auto rib = [](int d) { return d >= 0 && d < 3 ? 4.0 : 0.0; };
  const Division left_hand(rib, {0.0, 2.0}, 0, 1.0), right_hand(rib, {-2.0, 0.0}, 1, 1.0);
  EXPECT_GE(left_hand.best, -1.0);
  EXPECT_LE(left_hand.best, 0.0);
  EXPECT_GE(right_hand.best, 2.0);
  EXPECT_LE(right_hand.best, 3.0);
  // The surface between them is as wide as the rib.
  const auto at = static_cast<std::size_t>(std::lround((left_hand.best + 4.0) / Offsets::kStep));
  EXPECT_NEAR(left_hand.extents[at].high, 2.5, 0.75);
}

TEST(AcrossSearch, ABreakWithoutAStrokeIsFreeAtAPrice) {
  // A wall 6 samples off, with no hand on it, does not draw the own break away from its small step.
  const Division found([](int d) { return (d >= 0 ? 1.5 : 0.0) + (d >= 6 ? 20.0 : 0.0); }, {0.0}, 0, 0.5);
  EXPECT_GE(found.best, -1.0);
  EXPECT_LE(found.best, 0.0);
}

TEST(AcrossSearch, CurvedSurfacesMakeItLessCertain) {
  // The same step on a cylinder of radius 10: its planes leave residuals, so that costs are tempered.
  const auto spread = [](double curvature) {
    const Division found([&](int d) { return (d >= 0 ? 3.0 : 0.0) + curvature * d * d; }, {0.0}, 0, 0.05);
    return *std::max_element(found.costs.begin(), found.costs.end());
  };
  EXPECT_LT(spread(0.05), 0.75F * spread(0.0));
}

TEST(AcrossSearch, AllLevelsOfInstructionsGiveTheSameBits) {
  const auto wall = [](int d) { return (d >= 2 ? 3.0 : 0.0) + 0.01 * d * d; };
  const Division plain(wall, {-4.0, 0.0}, 1, 0.3, 5, CpuLevel::kPlain);
  for (const CpuLevel level : {CpuLevel::kAvx2, CpuLevel::kAvx512})
    if (level <= bestCpuLevel()) {
      EXPECT_EQ(Division(wall, {-4.0, 0.0}, 1, 0.3, 5, level).costs, plain.costs);
    }
}

TEST(AcrossSearch, WithoutSamplesOnlyTheHandCounts) {
  AcrossSearch::Model model;
  model.offsets.reach = 2.0;
  model.variance = 1.0;
  AcrossSearch search(model);
  search.clear();
  std::vector<float> costs(static_cast<std::size_t>(model.offsets.count()));
  std::vector<Extent> extents(costs.size());
  const double own = 0.0;
  search.solve({&own, 1}, 0, costs, extents);
  for (std::size_t k = 0; k < costs.size(); ++k) {
    const double off = model.offsets.at(static_cast<int>(k)) / model.deviation;
    EXPECT_NEAR(costs[k], off * off, 1e-5);
  }
}

}  // namespace
}  // namespace fettle::engine
