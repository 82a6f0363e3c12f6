// Holes that a file means and hardly says: in the description of a PNG that Fettle wrote, and as one number
// far from every height.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "engine/filter/filter.h"
#include "engine/io/lone_value.h"
#include "tests/engine/io/io_support.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

// 100 x 100 samples of which 500 hold `value`; the others lie between 10 and 15.
std::vector<float> with500(float value) {
  std::mt19937 random(8);
  std::vector<float> z(10000);
  for (std::size_t i = 0; i < z.size(); ++i)
    z[i] = i % 20 == 7 ? value : 10.0F + static_cast<float>(random() % 5000) * 0.001F;
  return z;
}

TEST(UndeclaredHoles, ThoseOfAPngThatFettleWroteAreHolesWhenItIsReadBack) {
  const TempFolder folder;
  for (const double per_count : {0.0, 0.002}) {
    Grid grid = gridOf(100, 100);
    grid.height_per_count = per_count;
    const Version field = makeField(grid, with500(kNan));
    ASSERT_TRUE(save(field, folder.file("holes.png")));
    FETTLE_LOAD(again, folder.file("holes.png"));
    EXPECT_EQ(summarize(again.field).no_data, 500);
    EXPECT_GE(summarize(again.field).min, 1.0);
    EXPECT_TRUE(warned(again.warnings, "the file states height = ")) << "the way to heights is not said";
    EXPECT_FALSE(warned(again.warnings, "--no-data"));
    // So that a filter leaves them alone, and no neighbour takes one for a height.
    FilterSpec spec;
    spec.window = 3;
    JobControl job;
    const auto filtered = applyFilter(again.field, again.field, spec, job);
    ASSERT_TRUE(filtered) << filtered.error().line();
    EXPECT_EQ(summarize(filtered->field).no_data, 500);
    EXPECT_GE(summarize(filtered->field).min, summarize(again.field).min);
  }
}

// A number that is mistyped explains nothing: what looks like holes is named as without it.
TEST(UndeclaredHoles, ANumberThatNoSampleHasIsSaidAndExplainsNoOther) {
  const TempFolder folder;
  ASSERT_TRUE(save(makeField(gridOf(100, 100), with500(2.5F)), folder.file("lone.tif")));
  ImportOptions options;
  options.no_data = 2.5;
  JobControl job;
  const auto right = importField(folder.file("lone.tif"), options, job);
  ASSERT_TRUE(right) << right.error().line();
  EXPECT_EQ(summarize(right->field).no_data, 500);
  EXPECT_TRUE(right->lone_values.empty());
  EXPECT_FALSE(warned(right->warnings, "no sample has"));
  options.no_data = 0.02;
  const auto wrong = importField(folder.file("lone.tif"), options, job);
  ASSERT_TRUE(wrong) << wrong.error().line();
  EXPECT_EQ(summarize(wrong->field).no_data, 0);
  EXPECT_TRUE(warned(wrong->warnings, "no sample has the no-data value 0.02: check --no-data"));
  ASSERT_EQ(wrong->lone_values.size(), 1U);
  EXPECT_EQ(wrong->lone_values.front().number, 2.5F);
}

TEST(UndeclaredHoles, APngWithoutHolesHasNoneThoughAHeightIsCountedAs0) {
  const TempFolder folder;
  Grid grid = gridOf(100, 100);
  grid.height_per_count = 0.5;
  std::vector<float> z;
  for (int i = 0; i < 10000; ++i) z.push_back(static_cast<float>(i % 100) * 0.5F);
  ASSERT_TRUE(save(makeField(grid, z), folder.file("whole.png")));
  FETTLE_LOAD(again, folder.file("whole.png"));
  EXPECT_EQ(summarize(again.field).no_data, 0);
  EXPECT_EQ(summarize(again.field).min, 0.0);
}

TEST(UndeclaredHoles, ALoneValueFarFromAllOthersIsSaidWithTheOptionThatTakesItOut) {
  const TempFolder folder;
  for (const auto& [value, option] :
       {std::pair{0.0F, "--no-data 0"}, {-9999.0F, "--no-data -9999"}, {999.0F, "--no-data 999"}}) {
    for (const char* name : {"lone.tif", "lone.xyz", "lone.exr"}) {
      SCOPED_TRACE(std::string(name) + " " + option);
      ASSERT_TRUE(save(makeField(gridOf(100, 100), with500(value)), folder.file(name)));
      FETTLE_LOAD(scan, folder.file(name));
      EXPECT_EQ(summarize(scan.field).no_data, 0);
      EXPECT_TRUE(warned(scan.warnings, option));
      EXPECT_TRUE(warned(scan.warnings, "5 % of the samples"));
      ImportOptions options;
      options.no_data = value;
      FETTLE_LOAD(without, folder.file(name), options);
      EXPECT_EQ(summarize(without.field).no_data, 500);
      EXPECT_FALSE(warned(without.warnings, "--no-data"));
    }
  }
}

TEST(UndeclaredHoles, TheOptionIsInTheNumbersThatTheFileStores) {
  const TempFolder folder;
  // Counts of 0.1 each, 0 between them at none.
  std::string text;
  for (int r = 0; r < 30; ++r)
    for (int c = 0; c < 30; ++c)
      text += std::to_string(c) + " " + std::to_string(r) + " " +
              std::to_string(c % 9 == 4 ? -32000 : 100 + (c * 7 + r * 3) % 50) + "\n";
  writeBytes(folder.file("counts.xyz"), text);
  ImportOptions options;
  options.z_scale = 0.1;
  FETTLE_LOAD(scan, folder.file("counts.xyz"), options);
  EXPECT_TRUE(warned(scan.warnings, "exactly -3200 mm"));
  EXPECT_TRUE(warned(scan.warnings, "--no-data -32000"));
}

// Each of the rare numbers above the others makes the range smaller once it is left out, and with it what is near; they are more than
// the passes over the field.
TEST(UndeclaredHoles, WhatIsSaidToBeNearWasCountedSo) {
  const TempFolder folder;
  constexpr int kSide = 512;
  std::mt19937 random(11);
  std::vector<float> z;
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) {
      const float noise = static_cast<float>(random() % 30000) * 1e-5F;
      z.push_back((r * 7 + c) % 100 == 0 ? 0.5F : noise + (random() % 2 == 0 ? 0.0F : 0.69F));
    }
  // By the rule below 1e20 and more, which stand for holes.
  for (int i = 0; i < 6; ++i)
    z[static_cast<std::size_t>(200 * kSide + 40 + 7 * i)] = 1.1F + 0.1F * static_cast<float>(i);
  for (int i = 0; i < 30; ++i)
    z[static_cast<std::size_t>(300 * kSide + 40 + 7 * i)] = 0.5025F + 0.005F * static_cast<float>(i);
  const Version field = makeField(gridOf(kSide, kSide), z);
  HeightRule rule;
  rule.scale = 1e-20;
  std::vector<std::string> warnings;
  const auto lone = doubtLoneValues(field, rule, warnings);
  ASSERT_EQ(lone.size(), 1U);
  ASSERT_EQ(warnings.size(), 1U);
  int others = 0;
  double within = 0.0;
  const std::size_t at = warnings[0].find("only ");
  ASSERT_NE(at, std::string::npos) << warnings[0];
  ASSERT_EQ(std::sscanf(warnings[0].c_str() + at, "only %d others are within %lf", &others, &within), 2)
      << warnings[0];
  int counted = 0;
  for (const float height : z) counted += height != 0.5F && std::abs(double{height} - 0.5) < within ? 1 : 0;
  EXPECT_EQ(others, counted) << warnings[0];
}

TEST(UndeclaredHoles, SurfacesThatHaveAFlatAreNotDoubted) {
  const TempFolder folder;
  std::vector<float> steps, few, ground, part;
  std::mt19937 random(3);
  for (int i = 0; i < 10000; ++i) {
    const float noise = static_cast<float>(random() % 1000) * 0.001F;
    steps.push_back(static_cast<float>(i % 7) * 10.0F);      // few levels, each held by many
    few.push_back(i % 5 == 0 ? 0.0F : 3.0F + noise * 0.0F);  // two levels
    ground.push_back(i % 3 == 0 ? 0.0F : noise);             // a flat that the rest comes down to
    // Two flats and what lies between them, without noise: a part as it is designed.
    part.push_back(i % 5 < 2 ? 0.0F : i % 5 == 2 ? 18.0F : 8.0F + noise * 10.0F);
  }
  for (const std::vector<float>& z : {steps, few, ground, part}) {
    ASSERT_TRUE(save(makeField(gridOf(100, 100), z), folder.file("flat.tif")));
    FETTLE_LOAD(scan, folder.file("flat.tif"));
    EXPECT_FALSE(warned(scan.warnings, "--no-data")) << scan.warnings.front();
  }
}

// 200 x 150 heights of a part in counts of 0.01 mm, with noise: most of the samples share a few heights.
std::vector<float> quantised() {
  std::mt19937 random(11);
  std::normal_distribution<double> noise(0.0, 0.01);
  std::vector<float> z(30000);
  for (std::size_t i = 0; i < z.size(); ++i) {
    const std::size_t column = i % 200;
    const double height = column < 60    ? 0.0
                          : column < 120 ? 8.0
                                         : 18.0 - 0.1 * static_cast<double>(column % 80);
    z[i] = static_cast<float>(std::round((height + noise(random)) * 100.0) / 100.0);
  }
  return z;
}

// So many of the samples, every 14th from the first one, replaced by `value`.
std::vector<float> with(std::vector<float> z, std::size_t count, float value, std::size_t first = 3) {
  for (std::size_t i = 0; i < count; ++i) z[(first + 14 * i) % z.size()] = value;
  return z;
}

// Heights of a landscape from 150 to 600, a third of them a lake at exactly 190.
std::vector<float> landscape() {
  std::mt19937 random(5);
  std::vector<float> z(30000);
  for (std::size_t i = 0; i < z.size(); ++i) {
    const double hill = 375.0 + 225.0 * std::sin(static_cast<double>(i % 200) * 0.05);
    z[i] = i / 200 < 50 ? 190.0F : static_cast<float>(hill + static_cast<double>(random() % 1000) * 0.001);
  }
  return z;
}

class LoneValues : public testing::Test {
 protected:
  // What is said of a field, and that nothing is concluded from its lone values.
  std::vector<std::string> said(const std::vector<float>& z, double spacing = 1.0) {
    Grid grid = gridOf(200, 150);
    grid.spacing_x = grid.spacing_y = spacing;
    EXPECT_TRUE(save(makeField(grid, z), folder.file("f.tif")));
    const auto scan = load(folder.file("f.tif"));
    EXPECT_TRUE(scan) << scan.error().line();
    EXPECT_FALSE(warned(scan->warnings, "--z-scale")) << scan->warnings.back();
    return scan->warnings;
  }
  TempFolder folder;
};

TEST_F(LoneValues, NumbersThatStandForHolesAreSaidOnAQuantisedPart) {
  const auto two = said(with(with(quantised(), 2000, -9999.0F), 900, -32768.0F, 7), 0.1);
  EXPECT_TRUE(warned(two, "--no-data -9999"));
  EXPECT_TRUE(warned(two, "--no-data -32768"));
  EXPECT_TRUE(warned(two, "one at a time"));
  EXPECT_TRUE(warned(said(with(quantised(), 2000, -3.4028235e38F), 0.1), "--no-data -3.4028235e+38"));
  // One sample of it is enough to spoil every figure.
  EXPECT_TRUE(warned(said(with(quantised(), 1, 1e38F), 0.1), "--no-data 1e+38"));
  EXPECT_TRUE(warned(said(with(quantised(), 20, -9999.0F), 0.1), "--no-data -9999"));
}

TEST_F(LoneValues, NumbersThatStandForHolesAreSaidBesideALake) {
  const auto one = said(with(landscape(), 2025, -9999.0F));
  EXPECT_TRUE(warned(one, "6.75 % of the samples are exactly -9999 mm"));
  EXPECT_FALSE(warned(one, "190 mm"));
  const auto two = said(with(with(landscape(), 2000, 32767.0F), 900, 65535.0F, 7));
  EXPECT_TRUE(warned(two, "--no-data 32767"));
  EXPECT_TRUE(warned(two, "--no-data 65535"));
  // Hundreds of ranges away and farther than the field is long: no number that is known to stand for holes.
  EXPECT_TRUE(warned(said(with(landscape(), 2025, -123456.0F)), "--no-data -123456"));
  const auto both = said(with(with(landscape(), 2025, -123456.0F), 900, 200000.0F, 7));
  EXPECT_TRUE(warned(both, "--no-data -123456"));
  EXPECT_TRUE(warned(both, "--no-data 200000"));
}

TEST_F(LoneValues, ZeroIsSaidAmongHeightsInCoarseCounts) {
  std::mt19937 random(2);
  std::vector<float> z(30000);
  for (float& height : z) height = 20.0F + static_cast<float>(random() % 20) * 0.01F;
  EXPECT_TRUE(warned(said(with(z, 2000, 0.0F)), "--no-data 0"));
}

TEST_F(LoneValues, TheOtherIsSaidWhenOneOfTwoIsTakenOut) {
  Grid grid = gridOf(200, 150);
  ASSERT_TRUE(save(makeField(grid, with(with(landscape(), 2000, -9999.0F), 900, -32768.0F, 7)),
                   folder.file("two.tif")));
  ImportOptions options;
  options.no_data = -9999.0;
  FETTLE_LOAD(one, folder.file("two.tif"), options);
  EXPECT_FALSE(warned(one.warnings, "exactly -9999"));
  EXPECT_TRUE(warned(one.warnings, "--no-data -32768"));
  ASSERT_TRUE(save(one.field, folder.file("one.tif")));
  options.no_data = -32768.0;
  FETTLE_LOAD(none, folder.file("one.tif"), options);
  EXPECT_FALSE(warned(none.warnings, "--no-data"));
  EXPECT_EQ(summarize(none.field).no_data, 2900);
}

TEST_F(LoneValues, UnitsAreDoubtedWithoutThem) {
  // Said once, as a hole, and not again as a height that is too far or too steep.
  for (const float value : {-3.4028235e38F, 1e38F}) {
    const auto warnings = said(with(landscape(), 2025, value));
    EXPECT_TRUE(warned(warnings, "--no-data"));
    EXPECT_FALSE(warned(warnings, "more than on any planet"));
    EXPECT_FALSE(warned(warnings, "Half of all neighbours"));
  }
}

TEST_F(LoneValues, PartsWithALevelOfTheirOwnAreNotDoubted) {
  std::mt19937 random(9);
  std::vector<float> block, counted, plate, floor, mask, black;
  for (int i = 0; i < 30000; ++i) {
    const int column = i % 200, row = i / 200;
    const bool in_bore = std::hypot(column - 100, row - 75) < 30;
    const auto count = static_cast<float>(static_cast<int>(random() % 3) - 1) * 0.01F;
    block.push_back(column < 70 ? -9.999F : 0.0F);    // a gauge block without noise
    counted.push_back(column < 70 ? -10.0F : count);  // and in counts
    mask.push_back(column < 70 ? 65535.0F : 0.0F);    // a picture of two colours
    black.push_back(column < 70 ? 0.0F : 2.0F + 0.01F * count);
    // A lapped plate whose chamfer and form are a hundredth of a millimetre, and a bore deep below them.
    plate.push_back(in_bore ? -50.0F : row < 20 ? 0.0F : 0.0001F * static_cast<float>(row - 20));
    // A floor that lies below all of a part, exactly flat.
    floor.push_back(row < 60 ? -150.0F : column < 100 ? 0.0F : 0.01F * static_cast<float>(column - 100));
  }
  for (const std::vector<float>& z : {block, counted, plate, floor, mask, black}) {
    const auto warnings = said(z);
    EXPECT_FALSE(warned(warnings, "--no-data")) << warnings.back();
  }
}

// 200 x 150 heights about 0.08 in counts of 0.0001, and spikes from 0.04 to 0.3.
std::vector<float> chip() {
  constexpr double kCount = 0.0001;
  std::mt19937 random(12);
  std::normal_distribution<double> normal(0.08, 0.003);
  std::vector<float> z(30000);
  for (std::size_t i = 0; i < z.size(); ++i) {
    const double height = i % 1000 == 17 ? 0.04 + 0.26 * static_cast<double>(i) / 30000.0 : normal(random);
    z[i] = static_cast<float>(std::round(height / kCount) * kCount);
  }
  return z;
}

// A line that was missed is a fraction of a percent, and some other sample may be next to it.
TEST_F(LoneValues, ZeroesOfALineThatWasMissedAreSaid) {
  std::vector<float> z = chip();
  for (std::size_t c = 0; c < 90; ++c) z[c] = 0.0F;
  z[12345] = 0.0003F;
  const auto warnings = said(z);
  EXPECT_TRUE(warned(warnings, "--no-data 0"));
  EXPECT_TRUE(warned(warnings, "0.3 % of the samples are exactly 0 mm, and only 1 other is within 0.0"));
  std::vector<float> below = chip();
  for (std::size_t i = 0; i < below.size(); i += 200) below[i] = -50.0F;
  EXPECT_TRUE(warned(said(below), "--no-data -50"));
}

// Whichever line it is, of a field larger than what is looked at first.
TEST_F(LoneValues, ZeroesOfALineOfALargeFieldAreSaid) {
  const int wide = 600, high = 700;
  std::mt19937 random(13);
  std::normal_distribution<float> normal(5.0F, 0.1F);
  std::vector<float> noise(static_cast<std::size_t>(wide * high));
  for (float& height : noise) height = normal(random);
  for (const bool rows : {true, false})
    for (const int line : {0, 301, 302}) {
      std::vector<float> z = noise;
      for (int k = 0; k < (rows ? wide : high); ++k)
        z[static_cast<std::size_t>(rows ? line * wide + k : k * wide + line)] = 0.0F;
      ASSERT_TRUE(save(makeField(gridOf(wide, high), z), folder.file("line.tif")));
      FETTLE_LOAD(scan, folder.file("line.tif"));
      EXPECT_TRUE(warned(scan.warnings, "--no-data 0")) << (rows ? "row " : "column ") << line;
    }
}

// What is near to a height is a tenth of the others' range, with the one height above it: so 1.105 has others near it. Were it a
// third lone height beside 0.35 and 0.84, nothing would be said of any.
TEST_F(LoneValues, TwoAmongNoiseAreSaidBesideAFrequentTopOfIt) {
  std::mt19937 random(4);
  std::vector<float> z(30000);
  constexpr float kLowest[] = {0.0F, 0.5F, 0.98F}, kRange[] = {0.2F, 0.2F, 0.02F};
  for (float& height : z) {
    const std::size_t cluster = random() % 3;
    height = kLowest[cluster] + kRange[cluster] * static_cast<float>(random() % 10000) * 1e-4F;
  }
  for (std::size_t i = 0; i < z.size(); ++i)
    if (i % 50 < 3) z[i] = i % 50 == 0 ? 0.35F : i % 50 == 1 ? 0.84F : 1.105F;
  z[15025] = 1.109F;
  const auto warnings = said(z);
  EXPECT_TRUE(warned(warnings, "--no-data 0.35"));
  EXPECT_TRUE(warned(warnings, "--no-data 0.84"));
  EXPECT_FALSE(warned(warnings, "1.105"));
}

// Rare counts at the ends of noise, counts of every other number, and tops that are flat but for their rims.
TEST_F(LoneValues, RareHeightsThatOthersLieBesideAreNotDoubted) {
  std::mt19937 random(14);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<float> bytes, words, coarse, flat, pins, terraces;
  for (int i = 0; i < 30000; ++i) {
    const int column = i % 200, row = i / 200;
    const double noise = normal(random);
    bytes.push_back(static_cast<float>(0.01 * std::clamp(std::round(128.0 + 25.0 * noise), 0.0, 255.0)));
    words.push_back(static_cast<float>(0.004 * std::round(8000.0 + 300.0 * noise)));
    coarse.push_back(static_cast<float>(std::round(3.0 * noise)));
    // A pin on noisy ground: flat, its walls are sampled.
    const int out = std::max(std::abs(column - 100), std::abs(row - 75));
    const double wall = out < 6 ? 10.0 : out < 8 ? static_cast<double>(random() % 1000) * 0.01 : 0.0;
    flat.push_back(static_cast<float>(out < 8 ? wall : 0.3 * noise));
    // The same with noise in counts.
    pins.push_back(static_cast<float>(std::round((out < 8 ? 10.0 : 0.0) * 50.0 + 5.0 * noise) / 50.0));
    terraces.push_back(static_cast<float>(row / 5 * 3 + (column < 3 ? 50 : 0)));
  }
  for (const std::vector<float>& z : {bytes, words, coarse, flat, pins, terraces}) {
    const auto warnings = said(z);
    EXPECT_FALSE(warned(warnings, "--no-data")) << warnings.back();
  }
}

TEST_F(LoneValues, TheDistanceThatIsSaidIsThatToTheNearestHeightOnEitherSide) {
  // Two lands, from 0 to 1 and from 9 to 10.
  std::mt19937 random(4);
  std::vector<float> z(30000);
  for (std::size_t i = 0; i < z.size(); ++i)
    z[i] = (i % 2 == 0 ? 0.0F : 9.0F) + static_cast<float>(random() % 1001) * 0.001F;
  z[0] = 1.0F, z[1] = 9.0F, z[2] = 0.0F, z[5] = 10.0F;
  EXPECT_TRUE(warned(said(with(z, 900, 4.0F)), "exactly 4 mm, and no other height is within 3 mm"));
  EXPECT_TRUE(warned(said(with(z, 900, 7.0F)), "exactly 7 mm, and no other height is within 2 mm"));
  EXPECT_TRUE(warned(said(with(z, 900, -6.0F)), "exactly -6 mm, and no other height is within 6 mm"));
  EXPECT_TRUE(warned(said(with(z, 900, 999.0F)), "exactly 999 mm, and no other height is within 989 mm"));
}

// Frequent counts scatter over their neighbours above or below: the lower one of these is rare here, the higher one is not, and
// the other way round.
TEST_F(LoneValues, ZeroIsSaidBesideAnAbruptFootOfTheCounts) {
  std::mt19937 random(6);
  for (const bool turned : {false, true}) {
    std::vector<float> z(30000);
    for (float& height : z) {
      // Ten counts of half a percent each, two of 30 percent, eight of the rest.
      const auto percent2 = static_cast<int>(random() % 200);
      const int count = percent2 < 10    ? percent2
                        : percent2 < 70  ? 10
                        : percent2 < 130 ? 11
                                         : 12 + (percent2 - 130) % 8;
      height = 20.0F + 0.01F * static_cast<float>(turned ? 19 - count : count);
    }
    EXPECT_TRUE(warned(said(with(z, 2000, 0.0F)), "--no-data 0")) << turned;
  }
}

TEST_F(LoneValues, OfASmallFieldSixteenSamplesAreEnough) {
  std::mt19937 random(7);
  std::vector<float> z(1200);
  for (float& height : z) height = 10.0F + static_cast<float>(random() % 5000) * 0.001F;
  for (const std::size_t count : {std::size_t{16}, std::size_t{15}}) {
    ASSERT_TRUE(save(makeField(gridOf(40, 30), with(z, count, 0.0F)), folder.file("small.tif")));
    FETTLE_LOAD(scan, folder.file("small.tif"));
    EXPECT_EQ(warned(scan.warnings, "--no-data 0"), count == 16) << count;
  }
}

}  // namespace
}  // namespace fettle::engine
