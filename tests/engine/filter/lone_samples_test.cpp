#include "engine/filter/lone_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tests/engine/filter/reference.h"

namespace fettle::engine::tests {
namespace {

// Heights in standard deviations of their noise.
std::vector<LoneSample> loneOf(const PlainField& field) {
  return findLoneSamples(field.z.data(), field.width, field.width, field.height);
}

PlainField noisy(const std::function<float(int, int)>& z, unsigned seed = 3) {
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(0.0F, 1.0F);
  return formed(200, 150, [&](int c, int r) { return z(c, r) + noise(random); });
}

// A wall of 400 at column 100; what a scanner whose spot meets both sides gives lies between.
float wall(int c, int) {
  return c < 100 ? 0.0F : 400.0F;
}

TEST(LoneSamples, BetweenTwoSurfacesAreFoundAndFilledFromAround) {
  PlainField field = noisy(wall);
  std::mt19937 random(5);
  std::vector<std::pair<int, int>> mixed;
  for (int r = 2; r < 148; r += 3) {
    const int c = 98 + static_cast<int>(random() % 4);
    field.at(c, r) = 60.0F + static_cast<float>(random() % 280);
    mixed.emplace_back(c, r);
  }
  const std::vector<LoneSample> lone = loneOf(field);
  int found = 0, elsewhere = 0;
  for (const LoneSample& sample : lone) {
    const bool planted =
        std::ranges::find(mixed, std::pair<int, int>{sample.column, sample.row}) != mixed.end();
    (planted ? found : elsewhere) += 1;
    EXPECT_LT(std::min(std::fabs(sample.between), std::fabs(sample.between - 400.0F)), 4.0F);
  }
  EXPECT_GE(found, static_cast<int>(mixed.size()) - 2);
  EXPECT_EQ(elsewhere, 0);
}

TEST(LoneSamples, AreNotFoundInNoiseOnFormsThatAScanHas) {
  const std::pair<const char*, std::function<float(int, int)>> forms[] = {
      {"flat", [](int, int) { return 0.0F; }},
      {"wall", wall},
      {"steep plane",
       [](int c, int r) { return 25.0F * static_cast<float>(c) - 40.0F * static_cast<float>(r); }},
      {"ball",
       [](int c, int r) {
         return 8.0F * std::sqrt(std::max(
                           0.0F, 3600.0F - static_cast<float>((c - 100) * (c - 100) + (r - 75) * (r - 75))));
       }},
      {"ridge", [](int c, int r) { return -30.0F * std::fabs(static_cast<float>(c - 90 + r / 3)); }},
      {"wire of one sample", [](int c, int) { return c == 70 ? 50.0F : 0.0F; }},
      {"steps", [](int c, int r) { return 6.0F * static_cast<float>(c / 9 + r / 7); }},
      {"ribs of two samples", [](int c, int r) { return (c + r) % 8 < 2 ? 300.0F : 0.0F; }},
  };
  for (const auto& [name, form] : forms)
    for (const unsigned seed : {1U, 2U, 3U})
      EXPECT_LE(loneOf(noisy(form, seed)).size(), 6U) << name << " " << seed;
}

TEST(LoneSamples, ThatStickOutAreSpikesHoweverFew) {
  PlainField field = noisy([](int, int) { return 0.0F; });
  field.at(40, 50) = 1e6F;
  field.at(0, 0) = -90.0F;
  field.at(199, 149) = 30.0F;
  const std::vector<LoneSample> lone = loneOf(field);
  ASSERT_EQ(lone.size(), 3U);
  EXPECT_EQ(lone[1].column, 40);
  EXPECT_EQ(lone[1].row, 50);
  for (const LoneSample& sample : lone) EXPECT_LT(std::fabs(sample.between), 2.0F);
}

TEST(LoneSamples, AreOfNoUseWhereNothingElseIsKnown) {
  // Each sample is alone among holes: it keeps its height.
  const PlainField field = formed(9, 9, [](int c, int r) {
    return c % 4 == 0 && r % 4 == 0 ? static_cast<float>(100 * c + r)
                                    : std::numeric_limits<float>::quiet_NaN();
  });
  for (const LoneSample& sample : loneOf(field))
    EXPECT_EQ(sample.between, field.at(sample.column, sample.row));
  EXPECT_TRUE(loneOf(formed(0, 0, [](int, int) { return 0.0F; })).empty());
}

}  // namespace
}  // namespace fettle::engine::tests
