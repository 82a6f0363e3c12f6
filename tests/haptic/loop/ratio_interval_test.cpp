#include "haptic/loop/ratio_interval.h"

#include <cmath>
#include <deque>
#include <random>

#include <gtest/gtest.h>

namespace fettle::haptic {
namespace {

// Rounds of a machine whose rounds are good and bad by a factor of about 1.3; mine are `slower` times as late.
std::deque<TimingRound> measured(std::size_t count, double slower, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> of_round(0.0, 0.25);
  std::exponential_distribution<double> wait(1.0);
  std::deque<TimingRound> rounds;
  for (std::size_t i = 0; i < count; ++i) {
    TimingRound& round = rounds.emplace_back();
    const double mine = 20000.0 * slower * std::exp(of_round(random));
    const double other = 20000.0 * std::exp(of_round(random));
    for (int k = 0; k < 2000; ++k) {
      round.mine.add(std::llround(mine * wait(random)));
      round.other.add(std::llround(other * wait(random)));
    }
  }
  return rounds;
}

TEST(RatioInterval, HasTheTruthNineteenTimesInTwenty) {
  int inside = 0;
  double width = 0.0;
  constexpr int kTrials = 40;
  for (std::uint64_t seed = 0; seed < kTrials; ++seed) {
    const auto within = ratioIntervals(measured(24, 1.2, seed));
    ASSERT_TRUE(within);
    EXPECT_LE(within->p99.low, within->p99.high);
    if (within->p99.low <= 1.2 && 1.2 <= within->p99.high) ++inside;
    width += within->p99.high - within->p99.low;
  }
  // 38 expected; 24 rounds make the interval a little too narrow.
  EXPECT_GE(inside, 33);
  EXPECT_LT(width / kTrials, 0.5) << "it says something";
}

TEST(RatioInterval, IsThatOfTheRatioWhereAllRoundsAreAlike) {
  std::deque<TimingRound> rounds;
  for (std::size_t i = 0; i < kFewestRounds; ++i) {
    TimingRound& round = rounds.emplace_back();
    for (int k = 0; k < 1000; ++k) {
      round.mine.add(30);
      round.other.add(20);
    }
  }
  const auto within = ratioIntervals(rounds);
  ASSERT_TRUE(within);
  EXPECT_EQ(within->p99.low, 1.5);
  EXPECT_EQ(within->p99.high, 1.5);
  EXPECT_EQ(within->p999.high, 1.5);
  rounds.pop_back();
  EXPECT_FALSE(ratioIntervals(rounds)) << "too few";
}

TEST(RatioInterval, IsNotClaimedBesideZero) {
  std::deque<TimingRound> rounds(kFewestRounds);
  for (TimingRound& round : rounds) {
    round.mine.add(30);
    round.other.add(0);
  }
  EXPECT_FALSE(ratioIntervals(rounds));
}

}  // namespace
}  // namespace fettle::haptic
