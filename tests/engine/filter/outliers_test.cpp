#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/scanner/counter_random.h"
#include "tests/engine/filter/reference.h"

namespace fettle::engine::tests {
namespace {

constexpr int kOutlierSide = 96;
constexpr double kOutlierRange = 0.1;

FilterSpec outlierSpec(int window) {
  FilterSpec spec = makeSpec(FilterKind::kOutliers, window);
  spec.range_sigma = kOutlierRange;
  return spec;
}

PlainField withoutOutliers(const PlainField& field, int window) {
  return toPlain(filtered(toVersion(field), outlierSpec(window)).field);
}

// Noise of a fiftieth of the range.
float quietNoise(int c, int r) {
  return static_cast<float>(0.02 * kOutlierRange * CounterRandom(5, 0).normal(c, r));
}

TEST(Outliers, SpikesAndPitsOfUpToTheReachGo) {
  for (const int window : {3, 5, 7}) {
    const int reach = window / 2;
    const auto slope = [](int c, int r) { return 0.002F * static_cast<float>(c + 2 * r) + quietNoise(c, r); };
    PlainField field = formed(kOutlierSide, kOutlierSide, slope);
    const PlainField before = field;
    for (int r = 10; r < 90; r += 20)
      for (int c = 10; c < 90; c += 20)
        for (int i = 0; i < reach; ++i) field.at(c + i % 2, r + i / 2) += (c + r) % 40 == 0 ? 1e6F : -3.0F;
    const PlainField after = withoutOutliers(field, window);
    for (int r = 0; r < kOutlierSide; ++r)
      for (int c = 0; c < kOutlierSide; ++c) {
        const bool spike = field.at(c, r) != before.at(c, r);
        // The median of a window on this slope is within its half height of it.
        if (spike)
          EXPECT_NEAR(after.at(c, r), before.at(c, r), 0.002 * 3 * reach + 0.1 * kOutlierRange) << window;
        else
          EXPECT_TRUE(sameBits(after.at(c, r), field.at(c, r))) << window << " " << c << " " << r;
      }
  }
}

// Of one more sample than the window reaches: no spike any more.
TEST(Outliers, LargerGroupsStay) {
  PlainField field = formed(kOutlierSide, kOutlierSide, quietNoise);
  for (const int c : {40, 41, 42}) field.at(c, 40) += 1.0F;
  EXPECT_TRUE(sameBits(withoutOutliers(field, 5), field));
  EXPECT_FALSE(sameBits(withoutOutliers(field, 7), field));
}

// Ribs and grooves of one sample's width in all directions, with their ends; steps, terraces and their corners; cones.
TEST(Outliers, KeepsEveryBitOfWhatAScannerSeesOfAPart) {
  for (int degrees = 0; degrees < 180; degrees += 7) {
    const double x = std::cos(degrees * std::numbers::pi / 180),
                 y = std::sin(degrees * std::numbers::pi / 180);
    PlainField field = formed(kOutlierSide, kOutlierSide, quietNoise);
    // A sample for each step along the longer direction, as a line is drawn.
    const double longer = std::max(std::abs(x), std::abs(y));
    for (int i = -20; i <= 20; ++i)
      field.at(48 + static_cast<int>(std::lround(i * x / longer)),
               48 + static_cast<int>(std::lround(i * y / longer))) += degrees % 2 == 0 ? 2.0F : -2.0F;
    for (const int window : {3, 5, 9})
      EXPECT_TRUE(sameBits(withoutOutliers(field, window), field)) << degrees << " " << window;
    const auto step = [&](int c, int r) {
      return ((c - 48) * x + (r - 48) * y > 0.0 && (r - 48) * x - (c - 48) * y > 0.0 ? 5.0F : 0.0F) +
             quietNoise(c, r);
    };
    const PlainField corner = formed(kOutlierSide, kOutlierSide, step);
    for (const int window : {3, 5, 9})
      EXPECT_TRUE(sameBits(withoutOutliers(corner, window), corner)) << degrees << " " << window;
  }
  for (const double steepness : {0.01, 1.0, 100.0}) {
    const auto cone = [&](int c, int r) {
      return static_cast<float>(-steepness * std::hypot(c - 48.3, r - 47.6)) + quietNoise(c, r);
    };
    const PlainField field = formed(kOutlierSide, kOutlierSide, cone);
    // Neither the tip nor a corner of the field stands farther apart than what is next to it.
    const PlainField after = withoutOutliers(field, 3);
    int changed = 0;
    for (std::size_t i = 0; i < field.z.size(); ++i) changed += sameBits(after.z[i], field.z[i]) ? 0 : 1;
    EXPECT_EQ(changed, 0) << steepness;
  }
}

// The last sample of a plane that is steeper than the range lies below all of its window where it meets a wall.
TEST(Outliers, KeepsASteepPlaneUpToAWall) {
  for (const double steepness : {0.5, 1.3, 4.0}) {
    const auto meets = [&](int c, int r) {
      const double plane = steepness * kOutlierRange * (0.9 * (48 - c) + 0.4 * (48 - r));
      return static_cast<float>(3 * (c - 48) + 4 * (r - 48) > 0 ? plane + 20.0 : plane) + quietNoise(c, r);
    };
    const PlainField field = formed(kOutlierSide, kOutlierSide, meets);
    for (const int window : {3, 5}) EXPECT_TRUE(sameBits(withoutOutliers(field, window), field)) << steepness;
  }
}

// Without a majority that it stands apart from, nothing is an outlier.
TEST(Outliers, FewSamplesAmongHolesStay) {
  PlainField field =
      formed(9, 9, [](int c, int r) { return (c % 4 == 0 && r % 4 == 0) ? 1.0F : std::nanf(""); });
  field.at(1, 0) = 7.0F;
  EXPECT_TRUE(sameBits(withoutOutliers(field, 3), field));
  const PlainField row = formed(9, 1, [](int c, int) { return c == 4 ? 3.0F : 1.0F; });
  EXPECT_EQ(withoutOutliers(row, 3).at(4, 0), 1.0F);
  const PlainField end = formed(9, 1, [](int c, int) { return c == 0 ? 3.0F : 1.0F; });
  EXPECT_EQ(withoutOutliers(end, 3).at(0, 0), 3.0F);
  const PlainField one = formed(1, 1, [](int, int) { return 3.0F; });
  EXPECT_EQ(withoutOutliers(one, 5).at(0, 0), 3.0F);
}

// Where holes or the border leave no two samples opposite each other, three that are not on one line are enough.
TEST(Outliers, SpikesInCornersAndBesideRaggedHolesGo) {
  PlainField field = formed(kOutlierSide, kOutlierSide, quietNoise);
  const PlainField before = field;
  constexpr int kLast = kOutlierSide - 1;
  std::vector<std::pair<int, int>> spikes{{0, 0},         {kLast, 0}, {0, kLast},
                                          {kLast, kLast}, {0, 30},    {30, kLast}};
  // A sample that reaches into a hole: on one side its neighbours are missing, and one above or below.
  for (int c = 10; c < 90; c += 12) {
    for (int r = 39; r <= 41; ++r) field.at(c - 1, r) = std::nanf("");
    field.at(c, 39) = std::nanf("");
    field.at(c + 1, 39) = std::nanf("");
    spikes.emplace_back(c, 40);
  }
  for (const auto& [c, r] : spikes) field.at(c, r) += (c + r) % 4 == 0 ? 2.0F : -2.0F;
  for (const int window : {3, 5}) {
    const PlainField after = withoutOutliers(field, window);
    for (const auto& [c, r] : spikes)
      EXPECT_NEAR(after.at(c, r), before.at(c, r), kOutlierRange) << window << ": " << c << ", " << r;
    int changed = 0;
    for (std::size_t i = 0; i < field.z.size(); ++i) changed += sameBits(after.z[i], field.z[i]) ? 0 : 1;
    EXPECT_EQ(changed, static_cast<int>(spikes.size())) << window;
  }
}

// With a window of 3 the samples of one line cannot tell a spike from the end of a slope; with 5 the next line can.
TEST(Outliers, SpikesBesideOneLineOfSamplesNeedALargerWindow) {
  PlainField field = formed(kOutlierSide, kOutlierSide, quietNoise);
  for (int r = 0; r < kOutlierSide; ++r)
    for (int c = 48; c < kOutlierSide; ++c) field.at(c, r) = std::nanf("");
  field.at(48, 40) = 3.0F;
  EXPECT_TRUE(sameBits(withoutOutliers(field, 3), field));
  EXPECT_NEAR(withoutOutliers(field, 5).at(48, 40), 0.0, kOutlierRange);
}

// A steep plane goes on to the last sample of a ragged rim, also where that is beyond all others by far.
TEST(Outliers, KeepsASteepPlaneUpToARaggedHole) {
  for (const double steepness : {0.5, 2.0, 30.0})
    for (int degrees = 0; degrees < 360; degrees += 30) {
      const double x = std::cos(degrees * std::numbers::pi / 180),
                   y = std::sin(degrees * std::numbers::pi / 180);
      PlainField field = formed(kOutlierSide, kOutlierSide, [&](int c, int r) {
        return static_cast<float>(steepness * kOutlierRange * (x * c + y * r)) + quietNoise(c, r);
      });
      const CounterRandom random(3, 0);
      for (int r = 0; r < kOutlierSide; ++r)
        for (int c = 0; c < kOutlierSide; ++c)
          if (random.uniform(c, r) < 0.4) field.at(c, r) = std::nanf("");
      for (const int window : {3, 5})
        EXPECT_TRUE(sameBits(withoutOutliers(field, window), field)) << steepness << " " << degrees;
    }
}

// Of normal noise a range of five standard deviations takes nothing; of three little.
TEST(Outliers, LeavesNoiseAlone) {
  constexpr double kSigma = kOutlierRange / 5.0;
  const auto noise = [](int c, int r) {
    return static_cast<float>(kSigma * CounterRandom(9, 0).normal(c, r));
  };
  const PlainField field = formed(1000, 1000, noise);
  const PlainField after = withoutOutliers(field, 3);
  int changed = 0;
  for (std::size_t i = 0; i < field.z.size(); ++i) changed += sameBits(after.z[i], field.z[i]) ? 0 : 1;
  EXPECT_LE(changed, 3);
}

}  // namespace
}  // namespace fettle::engine::tests
