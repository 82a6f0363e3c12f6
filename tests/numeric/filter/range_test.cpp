// The maximum principle: smoothing makes no height that its window did not bracket.
//
// Tolerance. The exact mean or median lies between the window's extremes, which are floats, and rounding to
// float is monotonic: so a result exact before that rounding cannot leave them. The box's quotient and sum
// are monotonic, too (count * extreme is exact in double). The Gaussian may be off by (n + 4) * 2^-51 of the
// window's largest magnitude before it is rounded: below a quarter of the extreme's own last bit unless
// magnitudes differ by 2^20 and more, so leaving the range is rare but legal.

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/field/live_field.h"
#include "haptic/tick/brush.h"
#include "tests/numeric/filter/cases.h"
#include "tests/numeric/support/rare.h"

namespace fettle::engine::tests {
namespace {

// The float that `bound + error` can be rounded to at most.
float roundedAbove(float bound, long double error) {
  return static_cast<float>(static_cast<long double>(bound) + error);
}

// Samples outside the range of their window by more than may be; those within what may be are counted.
std::string leaving(const PlainField& before, const PlainField& after, const FilterCase& filter,
                    fettle::tests::Rare& beyond) {
  const WindowExtremes extremes = windowExtremes(before, filter.spec.window);
  for (std::size_t i = 0; i < before.z.size(); ++i) {
    const float z = after.z[i];
    if (std::isnan(before.z[i])) {
      if (!std::isnan(z)) return fmt::format("sample {}: a hole was filled\n", i);
      continue;
    }
    if (!std::isfinite(z)) return fmt::format("sample {}: {} came of {}\n", i, z, before.z[i]);
    const long double error = filter.errorOf(extremes.magnitude(i));
    if (z > roundedAbove(extremes.high[i], error) || z < -roundedAbove(-extremes.low[i], error))
      return fmt::format("sample {}: {:a} is not in [{:a}, {:a}]\n", i, z, extremes.low[i], extremes.high[i]);
    beyond.saw(z > extremes.high[i] || z < extremes.low[i]);
  }
  return {};
}

class Range : public testing::TestWithParam<std::string> {};

TEST_P(Range, NoResultLeavesTheHeightsOfItsWindow) {
  const PlainField before = hardField(GetParam());
  for (const FilterCase& filter : filterCases()) {
    SCOPED_TRACE(filter.name);
    // One sample in a hundred thousand, of fields whose heights span more than 2^20.
    fettle::tests::Rare beyond(
        fmt::format("{} on {} leaves its window by a rounding", filter.name, GetParam()),
        filter.error > 0.5 ? 1e-5 : 0.0);
    EXPECT_EQ(leaving(before, toPlain(filtered(toVersion(before), filter.spec).field), filter, beyond), "");
  }
}

TEST_P(Range, ShrinksFromPassToPass) {
  // Of the whole field, pass by pass: neither a height above the highest ever comes to be nor one below the
  // lowest, so nothing can be amplified.
  const Version start = toVersion(hardField(GetParam()));
  if (start.reader().bounds().empty()) return;
  for (const FilterCase& filter : filterCases()) {
    SCOPED_TRACE(filter.name);
    Version now = start;
    for (int pass = 0; pass < 6; ++pass) {
      const HeightBounds before = now.reader().bounds();
      now = filtered(now, filter.spec).field;
      const HeightBounds after = now.reader().bounds();
      const long double error = filter.errorOf(std::fmax(std::fabs(before.min), std::fabs(before.max)));
      EXPECT_LE(after.max, roundedAbove(before.max, error));
      EXPECT_GE(after.min, -roundedAbove(-before.min, error));
    }
  }
}

TEST_P(Range, IsKeptByTheBrushAtEveryStrength) {
  // gauss + s (box - gauss) in double: three sums and quotients of nine, each within 9 * 2^-53 of the
  // window's largest magnitude, and one rounding to float. 32 * 2^-53 bounds all of it.
  const PlainField before = hardField(GetParam());
  const Version start = toVersion(before);
  const WindowExtremes extremes = windowExtremes(before, 3);
  fettle::tests::Rare beyond(fmt::format("the brush on {} leaves its window by a rounding", GetParam()),
                             1e-4);
  for (const double strength : {0.0, 0.3, 0.77, 1.0}) {
    // One disc over the whole of a field: every sample reads the heights from before.
    haptic::Brush brush(std::hypot(before.width, before.height), std::nullopt, start);
    LiveField live(start, Growth::kAllowed);
    ASSERT_TRUE(brush.apply(live, before.width / 2, before.height / 2, strength));
    const PlainField after = toPlain(live.snapshot());
    for (std::size_t i = 0; i < before.z.size(); ++i) {
      ASSERT_EQ(std::isnan(after.z[i]), std::isnan(before.z[i]));
      if (std::isnan(before.z[i])) continue;
      const long double error = std::ldexp(static_cast<long double>(extremes.magnitude(i)), 5 - 53);
      ASSERT_LE(after.z[i], roundedAbove(extremes.high[i], error)) << i;
      ASSERT_GE(after.z[i], -roundedAbove(-extremes.low[i], error)) << i;
      beyond.saw(after.z[i] > extremes.high[i] || after.z[i] < extremes.low[i]);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Filters, Range, testing::ValuesIn(hardFieldNames()), [](const auto& test) {
  std::string text = test.param;
  std::replace(text.begin(), text.end(), ' ', '_');
  return text;
});

}  // namespace
}  // namespace fettle::engine::tests
