#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>

#include <gtest/gtest.h>

#include "tests/engine/filter/reference.h"

namespace fettle::engine::tests {
namespace {

class HardFields : public testing::TestWithParam<std::string> {};

TEST_P(HardFields, AreFilteredAsTheReferenceSaysForEveryKindAndWindow) {
  const PlainField plain = hardField(GetParam());
  const Version version = toVersion(plain);
  for (const FilterKind kind : kWindowed)
    for (const int window : {3, 5, 7, 9, 11, 15}) {
      SCOPED_TRACE(std::string(name(kind)) + " " + std::to_string(window));
      const FilterSpec spec = makeSpec(kind, window);
      EXPECT_EQ(checkPass(plain, toPlain(filtered(version, spec).field), spec, window < 7 ? 0 : 1500), "");
    }
}

TEST_P(HardFields, AreFilteredAsTheReferenceSaysWithAWindowLargerThanTheField) {
  const PlainField plain = hardField(GetParam());
  const Version version = toVersion(plain);
  for (const FilterKind kind : kWindowed)
    for (const int window : {101, 401, 1001}) {
      // Its time goes with the samples that windows share with the field: all of them with 401 already.
      const bool each_sample = kind == FilterKind::kBilateral || kind == FilterKind::kOutliers;
      if (each_sample && window > 101 && plain.z.size() > 5000) continue;
      SCOPED_TRACE(std::string(name(kind)) + " " + std::to_string(window));
      const FilterSpec spec = makeSpec(kind, window);
      EXPECT_EQ(checkPass(plain, toPlain(filtered(version, spec).field), spec, 60), "");
    }
}

TEST_P(HardFields, TakeATrueGaussianOfAnySigma) {
  const PlainField plain = hardField(GetParam());
  const Version version = toVersion(plain);
  for (const double sigma : {1e-3, 0.4, 2.7, 1e6})
    for (const int window : {3, 11}) {
      SCOPED_TRACE(std::to_string(sigma) + " " + std::to_string(window));
      const FilterSpec spec = makeSpec(FilterKind::kGaussian, window, sigma);
      EXPECT_EQ(checkPass(plain, toPlain(filtered(version, spec).field), spec, 500), "");
    }
}

TEST_P(HardFields, KeepBoxAndMedianBetweenTheWindowsExtremes) {
  const PlainField plain = hardField(GetParam());
  const Version version = toVersion(plain);
  for (const FilterKind kind : {FilterKind::kBox, FilterKind::kMedian})
    for (const int window : {3, 9}) {
      const PlainField after = toPlain(filtered(version, makeSpec(kind, window)).field);
      int outside = 0;
      for (int r = 0; r < plain.height; ++r)
        for (int c = 0; c < plain.width; ++c) {
          float low = std::numeric_limits<float>::infinity();
          float high = -low;
          for (int y = std::max(r - window / 2, 0); y <= std::min(r + window / 2, plain.height - 1); ++y)
            for (int x = std::max(c - window / 2, 0); x <= std::min(c + window / 2, plain.width - 1); ++x) {
              low = std::fmin(low, plain.at(x, y));
              high = std::fmax(high, plain.at(x, y));
            }
          if (!std::isnan(plain.at(c, r))) outside += after.at(c, r) < low || after.at(c, r) > high;
        }
      EXPECT_EQ(outside, 0) << name(kind) << " " << window;
    }
}

TEST_P(HardFields, ComeOutTurnedOverWhenTurnedOver) {
  const Version version = toVersion(hardField(GetParam()));
  for (const FilterKind kind : kEveryKind)
    for (const int window : windowsOf(kind, {3, 9})) {
      const FilterSpec spec = makeSpec(kind, window);
      const PlainField up = toPlain(filtered(version, spec).field);
      const Version turned = filtered(version.inverted(), spec).field;
      EXPECT_EQ(turned.reader().sign(), -1.0F);
      const PlainField down = toPlain(turned.inverted());
      int different = 0;
      for (std::size_t i = 0; i < up.z.size(); ++i)
        different += !(up.z[i] == down.z[i] || (std::isnan(up.z[i]) && std::isnan(down.z[i])));
      EXPECT_EQ(different, 0) << name(kind) << " " << window;
    }
}

INSTANTIATE_TEST_SUITE_P(Filters, HardFields, testing::ValuesIn(hardFieldNames()), [](const auto& test) {
  std::string text = test.param;
  for (char& c : text) c = c == ' ' ? '_' : c;
  return text;
});

TEST(Windows, OfOneSampleChangeNothing) {
  const Version version = toVersion(hardField("scattered holes"));
  for (const FilterKind kind : kWindowed) EXPECT_TRUE(filtered(version, makeSpec(kind, 1)).field == version);
}

TEST(Windows, OverAConstantGiveItBackToTheBitWithHolesAndBorders) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float z : {0.1F, -1e6F, 1.1e-40F, 3.4e38F, -0.0F}) {
    // The one other sample keeps the field from being flat as a whole; windows that see it are left out.
    const PlainField plain = formed(200, 80, [&](int c, int r) {
      return c == 199 && r == 79 ? 7.0F : (c * r) % 11 == 10 ? nan : z;
    });
    for (const FilterKind kind : kWindowed)
      for (const int window : {3, 7, 21}) {
        const PlainField after = toPlain(filtered(toVersion(plain), makeSpec(kind, window)).field);
        int different = 0;
        for (int r = 0; r < 80; ++r)
          for (int c = 0; c < 200 - 11; ++c) different += !sameBits(after.at(c, r), plain.at(c, r));
        EXPECT_EQ(different, 0) << name(kind) << " " << window << " " << z;
      }
  }
}

TEST(Windows, OverAPlaneGiveItBackToTheBitAwayFromTheBorder) {
  // Heights of 13 bits: every window's mean is the centre, and a float.
  const PlainField plain =
      formed(170, 150, [](int c, int r) { return 0.125F * static_cast<float>(3 * c - 2 * r); });
  for (const FilterKind kind : kWindowed)
    for (const int window : {3, 7, 21, 41}) {
      const PlainField after = toPlain(filtered(toVersion(plain), makeSpec(kind, window)).field);
      const int h = window / 2;
      int different = 0;
      for (int r = h; r < 150 - h; ++r)
        for (int c = h; c < 170 - h; ++c) different += after.at(c, r) != plain.at(c, r);
      EXPECT_EQ(different, 0) << name(kind) << " " << window;
    }
}

TEST(Windows, OfABoxAndAGaussianPreserveTheSumOfABumpAwayFromTheBorder) {
  const PlainField plain = formed(120, 120, [](int c, int r) {
    return c >= 50 && c < 70 && r >= 50 && r < 70 ? static_cast<float>((c * 37 + r * 101) % 97) * 0.01F
                                                  : 0.0F;
  });
  for (const FilterKind kind : {FilterKind::kBox, FilterKind::kGaussian})
    for (const int window : {3, 9, 31}) {
      const PlainField after = toPlain(filtered(toVersion(plain), makeSpec(kind, window)).field);
      long double sum_before = 0.0L, sum_after = 0.0L, tolerance = 0.0L;
      for (std::size_t i = 0; i < plain.z.size(); ++i) {
        sum_before += plain.z[i];
        sum_after += after.z[i];
        // Each output is off by at most half an ulp, but for parts in 2^40 of it.
        tolerance += after.z[i] == 0.0F ? 0.0L : 0.51L * ulp(after.z[i]);
      }
      EXPECT_LE(std::fabs(sum_after - sum_before), tolerance) << name(kind) << " " << window;
      EXPECT_GT(sum_before, 100.0L);
    }
}

TEST(Windows, OfABinomialGaussianHaveThePapersWeights) {
  // A single sample of 16 comes out as the 3 x 3 mask itself: 1 2 1, 2 4 2, 1 2 1.
  PlainField plain = formed(9, 9, [](int, int) { return 0.0F; });
  plain.at(4, 4) = 16.0F;
  const PlainField after = toPlain(filtered(toVersion(plain), makeSpec(FilterKind::kGaussian, 3)).field);
  const float mask[3][3] = {{1, 2, 1}, {2, 4, 2}, {1, 2, 1}};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) EXPECT_EQ(after.at(3 + c, 3 + r), mask[r][c]);
  EXPECT_EQ(after.at(2, 4), 0.0F);
}

// Tiles that neither a border nor a hole is near have paths of their own. With a hole in every tile none is taken, and samples whose
// windows do not reach a hole must not show it.
TEST(Windows, OverTilesWithoutHolesHaveTheBitsOfThoseWithHolesNearby) {
  std::uint64_t state = 7;
  const auto noise = [&state] {
    state = state * 6364136223846793005U + 1442695040888963407U;
    return static_cast<double>(state >> 11) * 0x1p-53 - 0.5;
  };
  // Magnitudes that are rounded away, ties, both zeros and denormals.
  PlainField plain = formed(5 * kTileSide, 5 * kTileSide, [&](int c, int r) {
    if (c / 50 % 3 == 1) return std::round(static_cast<float>(3.0 * noise()));
    if (c / 50 % 3 == 2)
      return static_cast<float>(std::ldexp(noise(), static_cast<int>(160.0 * noise()) - 60));
    return static_cast<float>(0.01 * r + noise());
  });
  for (int i = 0; i < 5 * kTileSide; i += 3) plain.at(i, i) = i % 2 == 0 ? 0.0F : -0.0F;
  plain.marks.resize(plain.z.size());
  for (std::size_t i = 0; i < plain.marks.size(); i += 7) plain.marks[i] = 1;
  const Version version = toVersion(plain);
  for (const FilterKind kind : {FilterKind::kBox, FilterKind::kGaussian, FilterKind::kMedian})
    for (const int window : {3, 5, 7, 9, 11})
      for (const double sigma : {0.0, 1.3}) {
        if (sigma != 0.0 && kind != FilterKind::kGaussian) continue;
        const FilterSpec spec = makeSpec(kind, window, sigma);
        const PlainField whole = toPlain(filtered(version, spec).field);
        const PlainField turned = toPlain(filtered(version.inverted(), spec).field.inverted());
        for (const int hole : {5, 32}) {
          PlainField holed = plain;
          for (int r = hole; r < plain.height; r += kTileSide)
            for (int c = hole; c < plain.width; c += kTileSide)
              holed.at(c, r) = std::numeric_limits<float>::quiet_NaN();
          const PlainField beside = toPlain(filtered(toVersion(holed), spec).field);
          int different = 0, compared = 0;
          const auto reached = [&](int x) { return std::abs(x % kTileSide - hole) <= window / 2; };
          for (int r = 0; r < plain.height; ++r)
            for (int c = 0; c < plain.width; ++c) {
              const auto wraps = [&](int x) { return reached(x) || reached(x + window / 2); };
              if (wraps(c) && wraps(r)) continue;
              ++compared;
              different += !sameBits(whole.at(c, r), beside.at(c, r));
              different += whole.at(c, r) != turned.at(c, r);
            }
          EXPECT_GT(compared, 60000);
          EXPECT_EQ(different, 0) << name(kind) << " " << window << " " << sigma;
        }
      }
}

TEST(Windows, OfAMedianOverAnEvenCountTakeTheMeanOfTheMiddleTwo) {
  // A corner's 3 x 3 window holds four samples: 1 2 4 8 there.
  const PlainField plain = formed(2, 2, [](int c, int r) { return std::ldexp(1.0F, 2 * r + c); });
  const PlainField after = toPlain(filtered(toVersion(plain), makeSpec(FilterKind::kMedian, 3)).field);
  for (const float z : after.z) EXPECT_EQ(z, 3.0F);
}

}  // namespace
}  // namespace fettle::engine::tests
