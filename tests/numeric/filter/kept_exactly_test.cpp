// What a filter has nothing to do to: constants, planes, sums. Each field has samples that differ somewhere,
// or no kernel would run at all: a tile whose surroundings are flat is passed over.

#include <cmath>
#include <limits>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/numeric/filter/cases.h"
#include "tests/numeric/support/rare.h"
#include "tests/support/no_data.h"

namespace fettle::engine::tests {
namespace {

// A constant with holes, a border on every side and one odd sample in each tile; whether a window of
// `radius` sees an odd one.
PlainField constantWithOddOnes(float z, float odd) {
  return formed(140, 130, [&](int c, int r) {
    if (c % 64 == 40 && r % 64 == 40) return odd;
    return (c * 7 + r * 3) % 29 == 0 ? kNan : z;
  });
}
bool seesOddOne(int c, int r, int radius) {
  const auto near = [&](int x) { return std::abs(x % 64 - 40) <= radius; };
  return radius >= 24 || (near(c) && near(r));
}

TEST(Constants, ComeBackToTheBitBesideHolesBordersAndOtherTiles) {
  // Exact: a constant's sum is count * z, and a double holds 2^20 times any float but for a rounding of
  // 2^-53, which the division and the rounding to float take back.
  int compared = 0;
  for (const float z : {0.1F, 1.0F / 3.0F, -1e6F, 5e6F + 0.5F, std::numeric_limits<float>::max(),
                        -std::numeric_limits<float>::max(), std::numeric_limits<float>::denorm_min(),
                        std::numeric_limits<float>::min(), -1.1e-40F, 0.0F, -0.0F})
    for (const float odd : {7.0F, 1e30F}) {
      const PlainField before = constantWithOddOnes(z, odd);
      for (const FilterCase& filter : filterCases()) {
        const PlainField after = toPlain(filtered(toVersion(before), filter.spec).field);
        int different = 0;
        for (int r = 0; r < before.height; ++r)
          for (int c = 0; c < before.width; ++c) {
            if (seesOddOne(c, r, filter.reach())) continue;
            different += !sameBits(after.at(c, r), before.at(c, r));
            ++compared;
          }
        EXPECT_EQ(different, 0) << filter.name << " of " << z << " next to " << odd;
      }
    }
  EXPECT_GT(compared, 1000000);
}

// a c + b r + k in steps that floats hold exactly, if `step` is a power of two.
PlainField plane(double a, double b, double k, double step) {
  return formed(150, 140, [=](int c, int r) { return static_cast<float>((a * c + b * r + k) * step); });
}

TEST(Planes, OfHeightsThatFloatsHoldAreKeptToTheBitAwayFromBorders) {
  // The exact mean of a whole window is its centre. What the kind may be off is a share of the window's
  // largest magnitude: below a quarter of the centre's last bit it rounds away, and it may show where the
  // plane crosses zero next to large heights.
  struct Plane {
    double a, b, k, step;
  };
  for (const Plane& p : {Plane{3, -2, 0, 0x1p-10},
                         {0, 1, 1 << 20, 0x1p-20},
                         {-7, 5, 60000, 1.0},
                         {1, 1, 0, 0x1p-149},
                         {1000, -1000, 0, 0x1p100}}) {
    const PlainField before = plane(p.a, p.b, p.k, p.step);
    for (const FilterCase& filter : filterCases()) {
      SCOPED_TRACE(fmt::format("{} on {} c + {} r + {}", filter.name, p.a, p.b, p.k));
      const PlainField after = toPlain(filtered(toVersion(before), filter.spec).field);
      const std::vector<std::uint8_t> whole = wholeWindows(before, filter.spec.window);
      const WindowExtremes extremes = windowExtremes(before, filter.spec.window);
      // A line of zero height crosses at most 150 + 140 samples of 21000, and a few steps next to it count.
      fettle::tests::Rare rounded("a plane off by a rounding near height zero",
                                  filter.error > 0.5 ? 0.05 : 0.0);
      for (std::size_t i = 0; i < before.z.size(); ++i) {
        if (whole[i] == 0) continue;
        const long double error = filter.errorOf(extremes.magnitude(i));
        const float z = before.z[i];
        const long double off = std::fabs(static_cast<long double>(after.z[i]) - z);
        // Rounded to float once: half a last bit in addition to the error itself, or nothing.
        ASSERT_LE(off, error < ulp(z) / 4 ? 0.0L : error + ulp(after.z[i]) / 2) << i;
        rounded.saw(off != 0.0L);
      }
    }
  }
}

TEST(Planes, RoundedToFloatsMoveByOneAndAHalfOfTheirLastBits) {
  // Each sample is off its plane by half a last bit of the window's largest magnitude at most, and so is
  // their mean; the centre is, too; the result is rounded once more: 1.5 in all. A median keeps the centre's
  // bits: rounding is monotonic, so as many samples are not below the centre as are not above it.
  std::mt19937 random(3);
  for (int round = 0; round < 6; ++round) {
    const auto slope = [&] { return (static_cast<double>(random() % 2001) - 1000.0) / 997.0; };
    const double a = slope(), b = slope(), k = round % 2 == 0 ? 0.0 : 5e6;
    const PlainField before = plane(a, b, k, round < 3 ? 1.0 : 1e-3);
    for (const FilterCase& filter : filterCases()) {
      SCOPED_TRACE(fmt::format("{} on {} c + {} r + {}", filter.name, a, b, k));
      const PlainField after = toPlain(filtered(toVersion(before), filter.spec).field);
      const std::vector<std::uint8_t> whole = wholeWindows(before, filter.spec.window);
      const WindowExtremes extremes = windowExtremes(before, filter.spec.window);
      for (std::size_t i = 0; i < before.z.size(); ++i) {
        if (whole[i] == 0) continue;
        const float largest = extremes.magnitude(i);
        const long double off = std::fabs(static_cast<long double>(after.z[i]) - before.z[i]);
        ASSERT_LE(off, filter.mean ? 1.5L * ulp(largest) + filter.errorOf(largest) : 0.0L) << i;
      }
    }
  }
}

TEST(Steps, AreKeptByAMedianAndCornersAreNot) {
  // A straight wall, however high, has five or more of nine samples on its own side; the corner of a square
  // has four. Larger windows likewise: n (n + 1) / 2 on the wall's side, ((n + 1) / 2)^2 at the corner.
  for (const float high : {1.0F, 1e6F, 3e38F})
    for (const FilterCase& filter : filterCases()) {
      if (filter.spec.kind != FilterKind::kMedian) continue;
      const Version wall = toVersion(formed(140, 100, [&](int c, int) { return c > 63 ? high : -0.5F; }));
      EXPECT_TRUE(filtered(wall, filter.spec).field == wall) << filter.name;
      const PlainField square =
          formed(140, 100, [&](int c, int r) { return c > 63 && r > 49 ? high : 0.0F; });
      const PlainField after = toPlain(filtered(toVersion(square), filter.spec).field);
      EXPECT_EQ(after.at(64, 50), 0.0F) << filter.name;
      EXPECT_EQ(after.at(64 + filter.reach(), 50), high) << filter.name;
    }
}

TEST(Sums, AreKeptByMeansAwayFromBorders) {
  // Heights that end far from the border: each is spread over whole windows with weights that add up to one,
  // so the exact sum stays. Each output adds its own rounding: half its last bit, and what the kind may be
  // off before. Twelve passes add up. All sums here are exact (ExactSum).
  std::mt19937 random(11);
  for (const FilterCase& filter : filterCases()) {
    if (!filter.mean) continue;
    SCOPED_TRACE(filter.name);
    const int passes = filter.reach() > 10 ? 2 : 12;
    // A height spreads by the reach each pass, and the windows that see it there reach once more.
    const int margin = (passes + 1) * filter.reach() + 1;
    for (const float offset : {0.0F, 1000.0F}) {
      PlainField now = formed(2 * margin + 37, 2 * margin + 31, [&](int c, int r) {
        const bool inside = c >= margin && r >= margin && c < margin + 37 && r < margin + 31;
        return offset + (inside ? static_cast<float>(random() % 100000) * 1e-3F - 40.0F : 0.0F);
      });
      ExactSum drift;
      for (const float z : now.z) drift.add(z, -1);
      long double allowed = 0.0L, variance = 0.0L;
      for (int pass = 0; pass < passes; ++pass) {
        const WindowExtremes extremes = windowExtremes(now, filter.spec.window);
        now = toPlain(filtered(toVersion(now), filter.spec).field);
        for (std::size_t i = 0; i < now.z.size(); ++i) {
          if (extremes.low[i] == extremes.high[i]) continue;  // one height: no rounding at all
          const long double half = ulp(now.z[i]) / 2 + filter.errorOf(extremes.magnitude(i));
          allowed += half;
          variance += half * half / 3;
        }
      }
      for (const float z : now.z) drift.add(z);
      EXPECT_LE(std::fabs(drift.value()), allowed);
      // Rounding is to nearest, so errors are even over half a last bit to both sides and share no sign: six
      // standard deviations of their sum make two chances in a billion. Cutting off would come near
      // `allowed` itself. On top of a large offset this is no longer so: a rim of less than half a last bit
      // is rounded away whole, always the same way.
      if (offset == 0.0F) {
        EXPECT_LE(std::fabs(drift.value()), 6.0L * std::sqrt(variance))
            << "of " << static_cast<double>(allowed);
      }
    }
  }
}

}  // namespace
}  // namespace fettle::engine::tests
