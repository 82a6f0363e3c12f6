#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "engine/filter/exact_sum.h"
#include "engine/filter/limit_change.h"
#include "engine/filter/median.h"
#include "engine/filter/ranks.h"
#include "tests/engine/filter/reference.h"
#include "tests/support/no_data.h"

namespace fettle::engine::tests {
namespace {

constexpr float kMax = std::numeric_limits<float>::max();

// Any float but NaN and infinities, all exponents alike, often a neighbour of a round number.
float anyFloat(std::mt19937& random) {
  for (;;) {
    std::uint32_t bits = static_cast<std::uint32_t>(random());
    if (random() % 2 == 0) bits &= 0xff800000U | (3U << (random() % 23));
    const float f = std::bit_cast<float>(bits);
    if (std::isfinite(f)) return f;
  }
}

SumLanes lanesFor(const std::vector<float>& z, std::int64_t count) {
  float magnitude = 0.0F;
  for (const float v : z) magnitude = std::fmax(magnitude, std::fabs(v));
  const auto n = static_cast<int>(z.size());
  return chooseLanes(z.data(), n, n, 1, magnitude, count);
}

TEST(ExactSums, NeedOneLaneForFixedPointHeightsTwoForMostFloatsAndNineForAll) {
  const auto lanes = [](const std::vector<float>& z, std::int64_t count) { return lanesFor(z, count).lanes; };
  EXPECT_EQ(lanes({0.0F, 65535.0F, 1.0F, -3.0F}, 1001 * 1001), 1);
  EXPECT_EQ(lanes({0.1F, 0.2F, -0.3F}, 1001 * 1001), 1);
  EXPECT_EQ(lanes({1e6F, 0.1F}, 9), 1);
  EXPECT_EQ(lanes({1e6F, 0.1F}, 1001 * 1001), 2);
  EXPECT_EQ(lanes({1e6F, 1e-3F, 1e-9F}, 9), 2);
  EXPECT_EQ(lanes({1e38F, 1e-38F}, 9), 9);
  EXPECT_EQ(lanes({kMax, std::numeric_limits<float>::denorm_min()}, 1001 * 1001), 9);
  EXPECT_EQ(lanes({0.0F, std::numeric_limits<float>::quiet_NaN()}, 9), 1);
}

// Samples below 2^t, and sums of n of them and differences of two such sums, take 1 + log2(2 n) places above 2^t: what is a
// multiple of 2^(t + 1 + log2(2 n) - 53) fits one lane, what is half of that does not.
TEST(ExactSums, TakeOneLaneToTheLastPlaceOfADouble) {
  const auto lanes = [](float least, std::int64_t count) { return lanesFor({1.0F, -least}, count).lanes; };
  EXPECT_EQ(lanes(0x1p-50F, 1), 1);
  EXPECT_EQ(lanes(0x1p-51F, 1), 2);
  EXPECT_EQ(lanes(0x1p-43F, 255), 1);
  EXPECT_EQ(lanes(0x1p-44F, 255), 2);
  EXPECT_EQ(lanes(0x1p-42F, 256), 1);
  EXPECT_EQ(lanes(0x1p-43F, 256), 2);
}

TEST(ExactSums, CutEveryFloatWithoutLoss) {
  std::mt19937 random(5);
  for (int round = 0; round < 2000; ++round) {
    std::vector<float> z;
    for (int i = 0; i < 8; ++i) z.push_back(anyFloat(random));
    const SumLanes s = lanesFor(z, 1001 * 1001);
    for (const float v : z) {
      double rest = static_cast<double>(v);
      double parts[SumLanes::kMaxLanes];
      for (int l = 0; l < s.lanes; ++l) {
        parts[l] = l + 1 < s.lanes ? (rest + s.cut[l]) - s.cut[l] : rest;
        rest -= parts[l];
        // A million such parts and their difference still fit 53 bits over the lane's last one.
        const double last_bit = std::ldexp(s.cut[l], -52) / 1.5;
        ASSERT_EQ(std::remainder(parts[l], last_bit), 0.0);
        ASSERT_LE(std::fabs(parts[l]) * 1001 * 1001 * 2, std::ldexp(last_bit, 53));
      }
      ASSERT_EQ(roundedSum(parts, s.lanes, 1), static_cast<double>(v));
    }
  }
}

TEST(ExactSums, AreRoundedToTheNearestDoubleTiesToEven) {
  const double tie[] = {1.0, std::ldexp(1.0, -53), 0.0};
  EXPECT_EQ(roundedSum(tie, 2, 1), 1.0);
  const double above[] = {1.0, std::ldexp(1.0, -53), std::ldexp(1.0, -140)};
  EXPECT_EQ(roundedSum(above, 3, 1), 1.0 + std::ldexp(1.0, -52));
  const double below[] = {1.0 + std::ldexp(1.0, -52), std::ldexp(1.0, -53), -std::ldexp(1.0, -140)};
  EXPECT_EQ(roundedSum(below, 3, 1), 1.0 + std::ldexp(1.0, -52));
  const double cancel[] = {1e30, 1e-30, -1e30};
  EXPECT_EQ(roundedSum(cancel, 3, 1), 1e-30);
  EXPECT_EQ(roundedSum(tie, 0, 1), 0.0);
}

TEST(Midpoints, AreTheNearestFloatToTheExactMean) {
  EXPECT_EQ(midpoint(1.0F, 2.0F), 1.5F);
  EXPECT_EQ(midpoint(kMax, kMax), kMax);
  EXPECT_EQ(midpoint(kMax, -kMax), 0.0F);
  EXPECT_EQ(midpoint(std::ldexp(1.0F, -149), std::ldexp(3.0F, -149)), std::ldexp(2.0F, -149));
  EXPECT_EQ(midpoint(2.0F * (1.0F + std::ldexp(1.0F, -23)), 1e-30F), 1.0F + std::ldexp(1.0F, -23));
  std::mt19937 random(11);
  for (int round = 0; round < 200000; ++round) {
    const float a = anyFloat(random);
    const float b = round % 3 == 0 ? std::nextafter(a, round % 2 == 0 ? 0.0F : kInf) : anyFloat(random);
    if (!std::isfinite(b)) continue;
    const float m = midpoint(a, b);
    const auto distance = [&](float f) {
      ExactSum d;
      d.add(a);
      d.add(b);
      d.add(f, -2);
      return std::fabs(d.value());
    };
    for (const float other : {std::nextafter(m, kInf), std::nextafter(m, -kInf)})
      if (std::isfinite(other)) {
        ASSERT_LE(distance(m), distance(other)) << a << " " << b;
      }
  }
}

TEST(LimitedChanges, ReachTheLastFloatWithinTheDistanceAndNoFurther) {
  std::mt19937 random(3);
  int drawn = 0;
  for (int round = 0; round < 200000; ++round) {
    // Magnitudes near each other, so that 64-bit long doubles hold the differences exactly.
    const float original = (round % 2 == 0 ? 1.0F : -1.0F) *
                           std::ldexp(1.0F + static_cast<float>(random() % 8388608U) / 8388608.0F,
                                      static_cast<int>(random() % 7) - 3);
    const double most =
        std::ldexp(static_cast<double>(random() % 4294967296U), -34 - static_cast<int>(random() % 12));
    const float height = original + (static_cast<float>(random() % 65536U) - 32768.0F) / 8192.0F;
    const float got = limitedChange(height, original, most);
    const auto change = [&](float f) { return std::fabs(static_cast<long double>(f) - original); };
    ASSERT_LE(change(got), static_cast<long double>(most)) << height << " " << original << " " << most;
    if (change(height) <= most) {
      ASSERT_EQ(got, height);
    } else {
      ++drawn;
      // One float further towards the height is too far.
      ASSERT_GT(change(std::nextafter(got, height)), static_cast<long double>(most));
    }
  }
  EXPECT_GT(drawn, 50000);
  EXPECT_EQ(limitedChange(7.0F, std::numeric_limits<float>::quiet_NaN(), 1.0), 7.0F);
  EXPECT_EQ(limitedChange(7.0F, 2.0F, 0.0), 2.0F);
  EXPECT_EQ(limitedChange(kMax, -kMax, 1e300), kMax);
  EXPECT_EQ(limitedChange(-kMax, kMax, 1e38), -(limitedChange(kMax, -kMax, 1e38)));
}

TEST(RankedSamples, AscendAndKeepTheirPlaces) {
  const PlainField plain = hardField("scattered holes");
  Block block;
  block.heights = plain.z.data();
  block.stride = plain.width;
  block.columns = plain.width;
  block.rows = plain.height;
  Ranks ranks;
  for (int again = 0; again < 2; ++again) {
    ranks.sort(block);
    std::vector<int> seen(plain.z.size() + 64);
    for (std::size_t i = 0; i < plain.z.size(); ++i) {
      const std::uint32_t rank = ranks.ranks()[i];
      if (std::isnan(plain.z[i])) {
        ASSERT_EQ(rank, ranks.holeRank());
        continue;
      }
      ASSERT_LT(rank, ranks.holeRank());
      ASSERT_EQ(seen[rank]++, 0);
      ASSERT_EQ(ranks.heights()[rank], plain.z[i]);
      if (rank > 0) {
        ASSERT_LE(ranks.heights()[rank - 1], plain.z[i]);
      }
    }
  }
}

}  // namespace
}  // namespace fettle::engine::tests
