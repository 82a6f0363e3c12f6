#include "engine/suggest/best_stretches.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace fettle::engine {
namespace {

// Along a row, a sample from point to point.
GainPath pathOf(std::vector<double> gains) {
  GainPath path;
  for (std::size_t i = 0; i < gains.size(); ++i) path.points.emplace_back(static_cast<double>(i), 0.0);
  path.gains = std::move(gains);
  return path;
}

double rateOf(const WorthStretch& s) {
  return s.gain / s.seconds;
}

// Of all stretches.
double bestRate(const GainPath& path, const HandPace& pace) {
  double best = -std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < path.gains.size(); ++a) {
    double gain = 0.0;
    for (std::size_t b = a; b < path.gains.size(); ++b) {
      gain += path.gains[b];
      best = std::max(best, gain / pace.seconds(static_cast<double>(b - a)));
    }
  }
  return best;
}

TEST(BestStretches, an_even_gain_is_one_stroke) {
  const HandPace pace;
  const auto found = bestStretches(pathOf(std::vector<double>(300, 2.0)), pace, 16.0);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].first, 0U);
  EXPECT_EQ(found[0].last, 299U);
  EXPECT_DOUBLE_EQ(found[0].gain, 600.0);
  EXPECT_DOUBLE_EQ(found[0].length, 299.0);
  EXPECT_DOUBLE_EQ(found[0].seconds, pace.reach_s + 299.0 / pace.samples_per_s);
}

TEST(BestStretches, where_nothing_is_gained_there_is_none) {
  EXPECT_TRUE(bestStretches({}, {}, 16.0).empty());
  EXPECT_TRUE(bestStretches(pathOf(std::vector<double>(300, 0.0)), {}, 16.0).empty());
  EXPECT_TRUE(bestStretches(pathOf(std::vector<double>(300, -1.0)), {}, 16.0).empty());
  EXPECT_TRUE(bestStretches(pathOf(std::vector<double>(10, 1.0)), {}, 16.0).empty())
      << "too short for a stroke";
}

TEST(BestStretches, what_is_worth_much_is_drawn_before_what_is_worth_little) {
  std::vector<double> gains(4000, 0.01);
  for (std::size_t i = 1000; i < 1800; ++i) gains[i] = 5.0;
  const auto found = bestStretches(pathOf(gains), {}, 16.0);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].first, 1000U);
  EXPECT_EQ(found[0].last, 1799U);
  EXPECT_GT(rateOf(found[0]), rateOf(found[1]));
  EXPECT_GT(rateOf(found[0]), rateOf(found[2]));
}

TEST(BestStretches, a_gain_at_one_point_is_drawn_with_what_is_next_to_it) {
  std::vector<double> gains(200, 0.0);
  gains[3] = 1.0;
  const auto found = bestStretches(pathOf(gains), {}, 16.0);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].first, 0U);
  EXPECT_GE(found[0].length, 16.0);
  EXPECT_LE(found[0].length, 18.0);
}

TEST(BestStretches, the_first_is_the_best_of_all_and_none_overlap) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.3, 1.0);
  for (int round = 0; round < 20; ++round) {
    std::vector<double> gains(400);
    for (double& gain : gains) gain = normal(random);
    const GainPath path = pathOf(gains);
    const HandPace pace{.reach_s = 0.1 + 0.2 * round, .samples_per_s = 200.0};
    const auto found = bestStretches(path, pace, 1.0);
    ASSERT_FALSE(found.empty());
    EXPECT_NEAR(rateOf(found[0]), bestRate(path, pace), 1e-9 * bestRate(path, pace));
    std::vector<bool> taken(gains.size(), false);
    for (const WorthStretch& stretch : found) {
      EXPECT_GT(stretch.gain, 0.0);
      for (std::size_t i = stretch.first; i <= stretch.last; ++i) {
        EXPECT_FALSE(taken[i]) << i;
        taken[i] = true;
      }
    }
  }
}

}  // namespace
}  // namespace fettle::engine
