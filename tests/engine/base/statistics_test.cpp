#include "engine/base/statistics.h"

#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace fettle::engine {
namespace {

std::vector<double> upTo(int n) {
  std::vector<double> values(static_cast<std::size_t>(n));
  std::iota(values.rbegin(), values.rend(), 1.0);  // n .. 1
  return values;
}

TEST(ErrorSummary, TheHundredthPartIsTheNearestRank) {
  EXPECT_EQ(errorSummary(upTo(100)).p99, 99.0);
  EXPECT_EQ(errorSummary(upTo(101)).p99, 100.0);
  EXPECT_EQ(errorSummary(upTo(1000)).p99, 990.0);
  EXPECT_EQ(errorSummary(upTo(1000)).worst, 1000.0);
  EXPECT_EQ(errorSummary(upTo(1000)).mean, 500.5);
  EXPECT_EQ(errorSummary({3.0}).p99, 3.0);
  EXPECT_EQ(errorSummary({2.0, 1.0}).p99, 2.0);
  EXPECT_EQ(errorSummary({}).worst, 0.0);
}

TEST(TimeSpread, HasTheMiddleAndTheWorst) {
  EXPECT_EQ(timeSpread(upTo(9)).median, 5.0);
  EXPECT_EQ(timeSpread(upTo(9)).worst, 9.0);
  EXPECT_EQ(timeSpread({4.0}).median, 4.0);
}

TEST(HashOf, IsThatOfItsAuthors) {
  EXPECT_EQ(hashOf({}), 0xcbf29ce484222325ULL);
  // Eight bytes of zero.
  const std::vector<double> zero{0.0};
  EXPECT_EQ(hashOf(zero), 0xa8c7f832281a39c5ULL);
  const std::vector<double> a{1.0, 2.0}, b{2.0, 1.0};
  EXPECT_NE(hashOf(a), hashOf(b));
}

}  // namespace
}  // namespace fettle::engine
