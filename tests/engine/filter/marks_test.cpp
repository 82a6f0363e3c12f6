#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/field/difference.h"
#include "engine/field/live_field.h"
#include "tests/engine/filter/reference.h"
#include "tests/support/no_data.h"

namespace fettle::engine::tests {
namespace {

// Every sign of trouble at once: noise, spikes, holes scattered and in a block, marks scattered and in a
// block.
PlainField markedField() {
  std::mt19937 random(7);
  PlainField p = formed(210, 170, [&](int c, int r) {
    if (random() % 23 == 0 || (c > 60 && c < 75 && r > 50 && r < 90)) return kNan;
    return (random() % 40 == 0 ? 50.0F : 0.0F) + static_cast<float>(random() % 4096) * 1.234e-3F;
  });
  for (int r = 0; r < p.height; ++r)
    for (int c = 0; c < p.width; ++c) p.marks.push_back(random() % 9 == 0 || (c > 120 && r < 70) ? 1 : 0);
  return p;
}

TEST(Marks, KeepTheirExactBitsButCountAsNeighbours) {
  const PlainField plain = markedField();
  for (const FilterKind kind : kEveryKind)
    for (const int window : windowsOf(kind, {3, 7, 11})) {
      const FilterSpec spec = makeSpec(kind, window);
      const Filtered result = filtered(toVersion(plain), spec);
      EXPECT_EQ(checkPass(plain, toPlain(result.field), spec), "") << name(kind) << " " << window;
      EXPECT_EQ(toPlain(result.field).marks, plain.marks);
      // Few windows of so rough a field fit a plane, and few samples stand apart.
      const bool few = kind == FilterKind::kPlanes || kind == FilterKind::kOutliers;
      EXPECT_GT(result.report.changed, few ? 30 : 10000);
    }
}

TEST(Marks, AloneAreFilteredWhenTheScopeSaysSo) {
  const PlainField plain = markedField();
  for (const FilterKind kind : kEveryKind)
    for (const int window : windowsOf(kind, {3, 7, 11})) {
      FilterSpec spec = makeSpec(kind, window);
      spec.scope = FilterScope::kOnlyMarks;
      const Filtered result = filtered(toVersion(plain), spec);
      EXPECT_EQ(checkPass(plain, toPlain(result.field), spec), "") << name(kind) << " " << window;
      const bool few = kind == FilterKind::kPlanes || kind == FilterKind::kOutliers;
      EXPECT_GT(result.report.changed, few ? 30 : 5000);
    }
}

TEST(Marks, StayUntouchedOverSeveralPassesAndEachPassFiltersTheOneBefore) {
  const PlainField plain = markedField();
  for (const FilterKind kind : kEveryKind)
    for (const FilterScope scope : {FilterScope::kKeepMarks, FilterScope::kOnlyMarks}) {
      FilterSpec once = makeSpec(kind, 5);
      once.scope = scope;
      FilterSpec thrice = once;
      thrice.passes = 3;
      Version one_by_one = toVersion(plain);
      for (int pass = 0; pass < 3; ++pass) one_by_one = filtered(one_by_one, once).field;
      EXPECT_TRUE(sameBits(toPlain(filtered(toVersion(plain), thrice).field), toPlain(one_by_one)));
    }
}

TEST(Marks, EverywhereOrNowhereLeaveNothingToFilter) {
  PlainField plain = markedField();
  plain.marks.assign(plain.z.size(), 1);
  FilterSpec spec = makeSpec(FilterKind::kBox, 5);
  const Version all = toVersion(plain);
  EXPECT_TRUE(filtered(all, spec).field == all);
  plain.marks.clear();
  spec.scope = FilterScope::kOnlyMarks;
  const Version none = toVersion(plain);
  const Filtered result = filtered(none, spec);
  EXPECT_TRUE(result.field == none);
  EXPECT_EQ(result.report.changed, 0);
  EXPECT_EQ(result.report.rms_change, 0.0);
}

TEST(Tiles, InWhichNothingChangedAreSharedWithTheInput) {
  // 5 x 4 tiles: flat but for one bump in tile (1, 1), a tile of holes (3, 1), and a noisy but wholly marked
  // tile (3, 3).
  PlainField plain = formed(320, 256, [](int c, int r) {
    if (c / 64 == 3 && r / 64 == 1) return kNan;
    if (c / 64 == 3 && r / 64 == 3) return static_cast<float>((c * 31 + r * 17) % 101);
    return c == 96 && r == 96 ? 9.0F : 2.5F;
  });
  plain.marks.resize(plain.z.size());
  for (int r = 192; r < 256; ++r)
    for (int c = 192; c < 256; ++c) plain.marks[static_cast<std::size_t>(r) * 320 + c] = 1;
  const Version before = toVersion(plain);
  for (const FilterKind kind : {FilterKind::kBox, FilterKind::kGaussian}) {
    const Version after = filtered(before, makeSpec(kind, 3)).field;
    std::vector<std::pair<int, int>> changed;
    for (const TileChange& t : changedTiles(before, after)) changed.emplace_back(t.tile_column, t.tile_row);
    // The bump's tile, and the three that touch the marked one: its heights count as their neighbours.
    const std::vector<std::pair<int, int>> want{{1, 1}, {2, 2}, {3, 2}, {4, 2}, {2, 3}, {4, 3}};
    EXPECT_EQ(changed, want) << name(kind);
  }
}

TEST(Tiles, ThatComeBackToWhatTheyWereAreSharedAgain) {
  const Version before = toVersion(markedField());
  FilterSpec spec = makeSpec(FilterKind::kMedian, 3);
  spec.passes = 2;
  spec.max_change = 0.0;  // every change is taken back
  const Filtered result = filtered(before, spec);
  EXPECT_TRUE(result.field == before);
}

TEST(Tiles, HaveRightBoundsAndCountsAfterFiltering) {
  const Version after = filtered(toVersion(markedField()), makeSpec(FilterKind::kBox, 5)).field;
  const Version rebuilt = toVersion(toPlain(after));
  const FieldReader a = after.reader();
  const FieldReader b = rebuilt.reader();
  for (int level = 0, side = 8; level < 3; ++level, side *= 8)
    for (int y = 0; y * side < a.height(); ++y)
      for (int x = 0; x * side < a.width(); ++x) EXPECT_EQ(a.bounds(level, x, y), b.bounds(level, x, y));
  EXPECT_EQ(summarize(after).no_data, summarize(rebuilt).no_data);
  EXPECT_EQ(summarize(after).marked, summarize(rebuilt).marked);
}

// |after - original| <= most in exact arithmetic, which long double gives: both are floats, the difference of
// two floats within 2^40 of each other fits 64 bits.
void expectWithin(const PlainField& after, const PlainField& original, double most) {
  int beyond = 0;
  for (std::size_t i = 0; i < after.z.size(); ++i)
    if (!std::isnan(after.z[i]) && !std::isnan(original.z[i]))
      beyond +=
          std::fabs(static_cast<long double>(after.z[i]) - original.z[i]) > static_cast<long double>(most);
  EXPECT_EQ(beyond, 0) << most;
}

TEST(MaxChange, IsNeverExceededOverSeveralPassesAgainstTheOriginal) {
  PlainField plain = markedField();
  plain.marks.clear();
  const Version original = toVersion(plain);
  for (const FilterKind kind : kEveryKind)
    for (const double most : {0.1, 1e-9, 0.02 / 3, 1.0, 1e9}) {
      FilterSpec spec = makeSpec(kind, 5);
      spec.max_change = most;
      spec.passes = 4;
      const Filtered first = filtered(original, spec);
      expectWithin(toPlain(first.field), plain, most);
      EXPECT_LE(first.report.max_change, most);
      // A second filter starts from the first one's result, under the same promise to the original.
      JobControl job;
      spec.kind = FilterKind::kBox;
      spec.range_sigma = spec.nesting_mm = 0.0;
      const Result<Filtered> second = applyFilter(first.field, original, spec, job);
      ASSERT_TRUE(second);
      expectWithin(toPlain(second->field), plain, most);
      if (most == 1e9) {
        FilterSpec unlimited = spec;
        unlimited.max_change.reset();
        EXPECT_TRUE(sameBits(toPlain(second->field), toPlain(filtered(first.field, unlimited).field)));
      }
    }
}

TEST(MaxChange, DrawsBackInputsThatHaveLeftTheOriginalAndSparesHolesOfTheOriginal) {
  const PlainField original = formed(70, 70, [](int c, int) { return c < 35 ? 1.0F : kNan; });
  const Version input = toVersion(formed(70, 70, [](int, int) { return 3.0F; }));
  for (const int window : {1, 3}) {
    FilterSpec spec = makeSpec(FilterKind::kBox, window);
    spec.max_change = 0.5;
    for (const Version& start : {input, input.inverted()}) {
      JobControl job;
      const Result<Filtered> result = applyFilter(start, toVersion(original), spec, job);
      ASSERT_TRUE(result);
      const float sign = start.reader().sign();
      EXPECT_EQ(result->field.reader().heightAt(10, 10), sign * 1.5F);
      EXPECT_EQ(result->field.reader().heightAt(60, 10), sign * 3.0F);
    }
  }
}

TEST(Report, StatesTheChangeAgainstTheInputOverSamplesThatAreNotHoles) {
  PlainField plain = formed(3, 1, [](int, int) { return 0.0F; });
  plain.at(1, 0) = 6.0F;
  plain.z.push_back(kNan);
  plain.width = 4;
  // Box over a row 0 6 0 -: means 3, 2, 3.
  const FilterReport report = filtered(toVersion(plain), makeSpec(FilterKind::kBox, 3)).report;
  EXPECT_EQ(report.changed, 3);
  EXPECT_EQ(report.max_change, 4.0);
  EXPECT_DOUBLE_EQ(report.rms_change, std::sqrt((9.0 + 16.0 + 9.0) / 3.0));
}

TEST(Spec, IsRefusedWithTheValueThatIsWrong) {
  const auto refused = [](auto change) {
    FilterSpec spec;
    change(spec);
    const Status status = validate(spec);
    return !status && status.error().kind == ErrorKind::kInput;
  };
  EXPECT_TRUE(validate(FilterSpec{}).has_value());
  EXPECT_TRUE(refused([](FilterSpec& s) { s.window = 0; }));
  EXPECT_TRUE(refused([](FilterSpec& s) { s.window = -3; }));
  EXPECT_TRUE(refused([](FilterSpec& s) { s.window = 4; }));
  EXPECT_TRUE(refused([](FilterSpec& s) { s.window = 1003; }));
  EXPECT_FALSE(refused([](FilterSpec& s) { s.window = 1001; }));
  EXPECT_TRUE(refused([](FilterSpec& s) { s.passes = 0; }));
  EXPECT_TRUE(refused([](FilterSpec& s) { s.sigma = 1.0; }));
  EXPECT_TRUE(refused([](FilterSpec& s) { s.kind = FilterKind::kGaussian, s.sigma = -1.0; }));
  EXPECT_TRUE(refused([](FilterSpec& s) { s.kind = FilterKind::kGaussian, s.sigma = std::nan(""); }));
  EXPECT_TRUE(refused([](FilterSpec& s) { s.range_sigma = 1.0; }));
  for (const FilterKind kind : {FilterKind::kBilateral, FilterKind::kTotalVariation})
    for (const double range : {0.0, -1.0, 1e31, std::nan("")})
      EXPECT_TRUE(refused([&](FilterSpec& s) { s.kind = kind, s.range_sigma = range; }));
  EXPECT_FALSE(refused([](FilterSpec& s) { s = makeSpec(FilterKind::kBilateral, 3, 2.0); }));
  EXPECT_TRUE(refused([](FilterSpec& s) { s = makeSpec(FilterKind::kTotalVariation, 3, 2.0); }));
  EXPECT_TRUE(refused([](FilterSpec& s) { s.max_change = -0.1; }));
  EXPECT_TRUE(refused([](FilterSpec& s) { s.max_change = std::numeric_limits<double>::infinity(); }));
  EXPECT_TRUE(refused([](FilterSpec& s) { s.threads = -1; }));
  const Version version = toVersion(hardField("noise"));
  JobControl job;
  EXPECT_FALSE(applyFilter(version, version, makeSpec(FilterKind::kBox, 2), job).has_value());
}

}  // namespace
}  // namespace fettle::engine::tests
