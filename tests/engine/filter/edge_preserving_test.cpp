#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "engine/field/difference.h"
#include "engine/filter/noise_range.h"
#include "engine/inspect/noise.h"
#include "tests/engine/filter/reference.h"

namespace fettle::engine::tests {
namespace {

constexpr FilterKind kRanged[] = {FilterKind::kBilateral, FilterKind::kTotalVariation};

class RangeOf : public testing::TestWithParam<std::string> {};

TEST_P(RangeOf, AnySizeIsFilteredAsTheReferenceSays) {
  const PlainField plain = hardField(GetParam());
  const Version version = toVersion(plain);
  for (const FilterKind kind : kRanged)
    for (const double range : {FilterSpec::kLeastRange, 1e-3, 2e4, FilterSpec::kMostRange})
      for (const int window : {3, 9}) {
        SCOPED_TRACE(std::string(name(kind)) + " " + std::to_string(range) + " " + std::to_string(window));
        FilterSpec spec = makeSpec(kind, window);
        spec.range_sigma = range;
        EXPECT_EQ(checkPass(plain, toPlain(filtered(version, spec).field), spec, 500), "");
      }
}

TEST_P(RangeOf, ABilateralResultLiesBetweenTheWindowsExtremesButForItsError) {
  const PlainField plain = hardField(GetParam());
  const FilterSpec spec = makeSpec(FilterKind::kBilateral, 5);
  const PlainField after = toPlain(filtered(toVersion(plain), spec).field);
  int outside = 0;
  for (int r = 0; r < plain.height; ++r)
    for (int c = 0; c < plain.width; ++c) {
      if (std::isnan(plain.at(c, r))) continue;
      float low = std::numeric_limits<float>::infinity(), high = -low;
      for (int y = std::max(r - 2, 0); y <= std::min(r + 2, plain.height - 1); ++y)
        for (int x = std::max(c - 2, 0); x <= std::min(c + 2, plain.width - 1); ++x) {
          low = std::fmin(low, plain.at(x, y));
          high = std::fmax(high, plain.at(x, y));
        }
      const long double z = after.at(c, r);
      const long double error = (5 + 64) * std::ldexp(0.25L, -22) + ulp(after.at(c, r));
      outside += !(z >= low - error && z <= high + error);
    }
  EXPECT_EQ(outside, 0);
}

TEST_P(RangeOf, ATotalVariationMovesNoSampleFurtherThanItSays) {
  const PlainField plain = hardField(GetParam());
  const PlainField after =
      toPlain(filtered(toVersion(plain), makeSpec(FilterKind::kTotalVariation, 41)).field);
  int beyond = 0;
  for (std::size_t i = 0; i < plain.z.size(); ++i)
    if (!std::isnan(plain.z[i]))
      beyond +=
          !(std::fabs(static_cast<long double>(after.z[i]) - plain.z[i]) <= 3.42L * 0.25L + ulp(after.z[i]));
  EXPECT_EQ(beyond, 0);
}

INSTANTIATE_TEST_SUITE_P(Filters, RangeOf, testing::ValuesIn(hardFieldNames()), [](const auto& test) {
  std::string text = test.param;
  for (char& c : text) c = c == ' ' ? '_' : c;
  return text;
});

// White noise of 0.02 on two flats a step of 2 apart.
PlainField noisyStep() {
  std::mt19937 random(8);
  std::normal_distribution<float> noise(0.0F, 0.02F);
  return formed(200, 160, [&](int c, int) { return (c < 100 ? 0.0F : 2.0F) + noise(random); });
}

double rmsOff(const PlainField& field, int c0, int c1) {
  double squares = 0.0;
  for (int r = 0; r < field.height; ++r)
    for (int c = c0; c < c1; ++c) {
      const double off = static_cast<double>(field.at(c, r)) - (c < 100 ? 0.0 : 2.0);
      squares += off * off;
    }
  return std::sqrt(squares / (static_cast<double>(field.height) * (c1 - c0)));
}

TEST(EdgePreserving, TakesTheNoiseOfFlatsAndLeavesAStepWhereABoxDestroysIt) {
  const PlainField plain = noisyStep();
  const Version version = toVersion(plain);
  JobControl job;
  for (const FilterKind kind : kRanged) {
    FilterSpec spec;
    spec.kind = kind;
    spec.window = kind == FilterKind::kBilateral ? 7 : 21;
    const auto ready = withMeasuredRange(spec, version, job);
    ASSERT_TRUE(ready);
    const PlainField after = toPlain(filtered(version, *ready).field);
    EXPECT_LT(rmsOff(after, 0, 80), 0.3 * rmsOff(plain, 0, 80)) << name(kind);
    EXPECT_LT(rmsOff(after, 97, 103), 0.6 * rmsOff(plain, 97, 103)) << name(kind);
  }
  EXPECT_GT(rmsOff(toPlain(filtered(version, makeSpec(FilterKind::kBox, 7)).field), 97, 103),
            10 * rmsOff(plain, 97, 103));
}

TEST(EdgePreserving, WorksAtAnyHeightAsItDoesAtZero) {
  // Heights of 1/64 so that adding 8192 is exact.
  const PlainField low =
      formed(90, 70, [](int c, int r) { return static_cast<float>((c * 7919 + r * 104729) % 61) / 64.0F; });
  PlainField high = low;
  for (float& z : high.z) z += 8192.0F;
  for (const FilterKind kind : kRanged) {
    const PlainField a = toPlain(filtered(toVersion(low), makeSpec(kind, 7)).field);
    const PlainField b = toPlain(filtered(toVersion(high), makeSpec(kind, 7)).field);
    for (std::size_t i = 0; i < a.z.size(); ++i)
      ASSERT_NEAR(static_cast<double>(b.z[i]) - 8192.0, static_cast<double>(a.z[i]),
                  0.6 * std::ldexp(1.0, -10))
          << name(kind);
  }
}

TEST(MeasuredRange, FollowsTheNoiseAndLeavesWhatIsGivenOrNotNeeded) {
  const Version version = toVersion(noisyStep());
  JobControl job;
  const double sigma = estimateNoise(version, job)->sigma;
  FilterSpec spec;
  EXPECT_EQ(withMeasuredRange(spec, version, job)->range_sigma, 0.0);
  spec.kind = FilterKind::kBilateral;
  EXPECT_EQ(withMeasuredRange(spec, version, job)->range_sigma, filterOf(spec.kind).noises * sigma);
  spec.range_sigma = 7.0;
  EXPECT_EQ(withMeasuredRange(spec, version, job)->range_sigma, 7.0);
  spec.range_sigma = 0.0;
  const Version still = toVersion(formed(30, 30, [](int c, int) { return static_cast<float>(c); }));
  const auto none = withMeasuredRange(spec, still, job);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::kInput);
}

}  // namespace
}  // namespace fettle::engine::tests
