#include "engine/measure/line_view.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/field/means.h"
#include "engine/measure/levelled_lines.h"
#include "tests/engine/measure/fields.h"

namespace fettle::engine {
namespace {

LineOffsets offsetsAt(const Version& field, const LineOptions& options,
                      const std::vector<std::int32_t>& places) {
  JobControl job;
  auto found = findLineOffsets(field, options, places, job);
  EXPECT_TRUE(found) << found.error().line();
  return found ? *std::move(found) : LineOffsets{};
}

// Lines with offsets and drift, noise along them, holes.
Version stripes(int width, int height, ScanAxis axis, const std::function<bool(int, int)>& marked = {}) {
  std::mt19937 random(4);
  std::normal_distribution<float> normal;
  std::vector<float> offsets(static_cast<std::size_t>(std::max(width, height)));
  for (float& each : offsets) each = normal(random);
  Grid grid;
  grid.width = width;
  grid.height = height;
  grid.spacing_x = 0.01;
  grid.spacing_y = 0.04;
  grid.origin_x = grid.origin_y = 5e6;
  std::vector<float> z;
  std::vector<std::uint8_t> marks;
  z.reserve(static_cast<std::size_t>(grid.samples()));
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) {
      const int line = axis == ScanAxis::kX ? r : c, along = axis == ScanAxis::kX ? c : r;
      const float own = offsets[static_cast<std::size_t>(line)];
      const bool hole = (c - 90) * (c - 90) + (r - 70) * (r - 70) < 400 || line == 33;
      z.push_back(hole ? std::nanf("") : own * (1.0F + 1e-4F * static_cast<float>(along)) + normal(random));
      if (marked) marks.push_back(marked(c, r) ? 1 : 0);
    }
  return makeField(grid, z, marks);
}

TEST(LineOffsetsAtPlaces, AreThoseOfTheSamplesThere) {
  std::vector<std::int32_t> every(300), some;
  std::iota(every.begin(), every.end(), 0);
  for (std::int32_t i = 2; i < 300; i += 1 + i % 5) some.push_back(i);
  for (const ScanAxis axis : {ScanAxis::kX, ScanAxis::kY}) {
    const int wide = axis == ScanAxis::kX ? 300 : 170, high = axis == ScanAxis::kX ? 170 : 300;
    const Version field = stripes(wide, high, axis, [&](int c, int r) {
      return std::ranges::binary_search(some, axis == ScanAxis::kX ? c : r);
    });
    for (const LineMethod method :
         {LineMethod::kMedian, LineMethod::kPolynomial, LineMethod::kDifference, LineMethod::kMatching})
      for (const bool robust : {false, true}) {
        LineOptions options;
        options.method = method;
        options.degree = 2;
        options.axis = axis;
        options.robust = robust;
        const LineOffsets all = offsetsAt(field, options, {});
        EXPECT_EQ(offsetsAt(field, options, every).coefficients, all.coefficients);
        const LineOffsets of_some = offsetsAt(field, options, some);
        EXPECT_NE(of_some.coefficients, all.coefficients);
        EXPECT_EQ(of_some.empty, 1);
        if (method == LineMethod::kMatching) continue;  // slopes of samples that are not marked are not known
        options.region = Region::kMarked;
        EXPECT_EQ(of_some.coefficients, offsetsAt(field, options, {}).coefficients)
            << static_cast<int>(method);
      }
  }
}

// Slopes next to a place are those of the field: of lines that are alike but for an offset each difference counts in full.
TEST(LineOffsetsAtPlaces, MatchBySlopesBetweenNeighbours) {
  std::vector<float> own(100);
  std::mt19937 random(9);
  for (float& each : own) each = std::normal_distribution<float>()(random);
  const Version field = fieldOf(400, 100, [&](int c, int r) {
    const double feature = c > 100 && c < 180 ? 5.0 * std::sin(0.3 * c * (1 + r % 3)) : 0.0;
    return own[static_cast<std::size_t>(r)] + std::sin(0.9 * c) + feature;
  });
  std::vector<std::int32_t> places;
  for (std::int32_t i = 0; i < 400; i += 7) places.push_back(i);
  LineOptions options;
  options.method = LineMethod::kMatching;
  const LineOffsets found = offsetsAt(field, options, places);
  const double mean = std::accumulate(own.begin(), own.end(), 0.0) / 100.0;
  for (std::size_t l = 0; l < 100; ++l)
    EXPECT_NEAR(found.coefficients[l], static_cast<double>(own[l]) - mean, 1e-5) << l;
}

Version levelledWhole(const Version& field, const LineOptions& options) {
  JobControl job;
  const auto offsets = findLineOffsets(field, options, job);
  EXPECT_TRUE(offsets) << offsets.error().line();
  auto levelled = levelledLines(field, *offsets, allTiles(field.grid()), job);
  EXPECT_TRUE(levelled) << levelled.error().line();
  return *std::move(levelled);
}

std::vector<EarlyPicture> levelledViews(LineView& lines, const FieldView& view) {
  std::vector<EarlyPicture> pictures;
  JobControl job;
  const auto done = lines.see(
      view, [&](EarlyPicture p) { pictures.push_back(std::move(p)); }, job);
  EXPECT_TRUE(done) << done.error().line();
  return pictures;
}

std::vector<EarlyPicture> levelledViews(const Version& field, const LineOptions& options,
                                        const FieldView& view) {
  LineView lines(field, options);
  return levelledViews(lines, view);
}

double rmsIn(const SampleRect& rect, const Version& a, const Version& b) {
  double squares = 0.0;
  std::int64_t compared = 0;
  for (std::int32_t r = rect.row; r < rect.row + rect.rows; ++r)
    for (std::int32_t c = rect.column; c < rect.column + rect.columns; ++c) {
      const double off =
          static_cast<double>(a.reader().heightAt(c, r)) - static_cast<double>(b.reader().heightAt(c, r));
      if (!std::isfinite(off)) continue;
      squares += off * off;
      ++compared;
    }
  EXPECT_GT(compared, 1000);
  return std::sqrt(squares / static_cast<double>(compared));
}

TEST(LineView, LevelsTheTilesInViewAndSaysHowFarTheyAreOff) {
  for (const ScanAxis axis : {ScanAxis::kX, ScanAxis::kY}) {
    const Version field = stripes(4200, 4100, axis);
    const FieldView view{{3, 0, 20, 20}, 800, 640};
    for (const auto& [method, degree] :
         {std::pair{LineMethod::kMedian, 0}, {LineMethod::kPolynomial, 1}, {LineMethod::kDifference, 0}}) {
      LineOptions options;
      options.method = method;
      options.degree = degree;
      options.axis = axis;
      const auto pictures = levelledViews(field, options, view);
      ASSERT_EQ(pictures.size(), 1U);
      const EarlyPicture& picture = pictures.back();
      EXPECT_EQ(picture.step, 1);
      ASSERT_TRUE(picture.off);
      EXPECT_TRUE(picture.off->estimated);
      const Version whole = levelledWhole(field, options);
      const double off = rmsIn({3 * kTileSide, 0, 20 * kTileSide, 20 * kTileSide}, picture.field, whole);
      EXPECT_GT(off, 0.0);
      // Of differences that add up the sum is off by other amounts in one part than in another.
      const double alike = method == LineMethod::kDifference ? 4.0 : 1.3;
      EXPECT_GT(picture.off->rms, off / alike) << static_cast<int>(method);
      EXPECT_LT(picture.off->rms, off * alike) << static_cast<int>(method);
      // Stripes are gone: they were of 1.
      EXPECT_LT(off, 0.6);
      EXPECT_EQ(picture.field.reader().heightAt(0, 0), field.reader().heightAt(0, 0)) << "not seen";
    }
    // All in view: means of what is levelled, less at rims of holes.
    LineOptions options;
    options.method = LineMethod::kPolynomial;
    options.degree = 1;
    options.axis = axis;
    const auto pictures = levelledViews(field, options, {allTiles(field.grid()), 2100, 2050});
    ASSERT_EQ(pictures.size(), 1U);
    const EarlyPicture& picture = pictures.back();
    EXPECT_EQ(picture.step, 5);
    const Version means = meansOf(levelledWhole(field, options), {0, 0, 4200, 4100}, 5);
    ASSERT_EQ(picture.field.grid().width, means.grid().width);
    const double off = rmsIn({30, 30, 700, 700}, picture.field, means);
    EXPECT_LT(off, picture.off->rms) << "five lines in a mean";
    EXPECT_GT(off, 0.3 * picture.off->rms);
  }
}

TEST(LineView, WhatComesIntoViewIsLevelledAlikeAndWhatWasSeenStays) {
  const Version field = stripes(4200, 4100, ScanAxis::kX);
  LineOptions options;
  options.method = LineMethod::kPolynomial;
  options.degree = 1;
  LineView lines(field, options);
  const auto one = levelledViews(lines, {{3, 0, 20, 20}, 800, 640});
  ASSERT_EQ(one.size(), 1U);
  // Some of it was seen.
  const auto other = levelledViews(lines, {{13, 15, 20, 20}, 1500, 1600});
  ASSERT_EQ(other.size(), 1U);
  EXPECT_EQ(other.back().off->rms, one.back().off->rms);
  const auto alone = levelledViews(field, options, {{13, 15, 20, 20}, 1500, 1600});
  const SampleRect seen{13 * kTileSide, 15 * kTileSide, 20 * kTileSide, 20 * kTileSide};
  EXPECT_EQ(rmsIn(seen, other.back().field, alone.back().field), 0.0);
  EXPECT_GT(rmsIn(seen, other.back().field, field), 0.5);
  EXPECT_EQ(rmsIn({3 * kTileSide, 0, 20 * kTileSide, 15 * kTileSide}, other.back().field, one.back().field),
            0.0);
  // All of it, and a part again.
  const auto all = levelledViews(lines, {allTiles(field.grid()), 2100, 2050});
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all.back().step, 5);
  EXPECT_EQ(contentHash(levelledViews(lines, {{3, 0, 20, 20}, 800, 640}).back().field),
            contentHash(other.back().field));
}

TEST(LineView, ShowsNothingWhereTheWholeTakesNoLonger) {
  const Version field = stripes(200, 100, ScanAxis::kX);
  EXPECT_TRUE(levelledViews(field, {}, {allTiles(field.grid()), 100, 50}).empty());
  const Version large = fieldOf(2100, 2100, [](int c, int r) { return 0.1 * (c + r % 5); });
  EXPECT_TRUE(levelledViews(large, {}, {}).empty()) << "nothing is seen";
  EXPECT_EQ(levelledViews(large, {}, {{0, 0, 2, 2}, 64, 64}).size(), 1U);
  const Version rows = fieldOf(200'000, 22, [](int c, int) { return 1e-6 * c; });
  EXPECT_EQ(levelledViews(rows, {}, {{0, 0, 2, 1}, 64, 0}).size(), 1U);
  const Version holes = fieldOf(2100, 2100, [](int, int) { return std::nan(""); });
  JobControl job;
  const FieldView part{{0, 0, 2, 2}, 64, 64};
  const auto refused = LineView(holes, {}).see(
      part, [](const EarlyPicture&) { FAIL(); }, job);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kInput);
  job.cancel();
  EXPECT_EQ(LineView(large, {})
                .see(
                    part, [](const EarlyPicture&) { FAIL(); }, job)
                .error()
                .kind,
            ErrorKind::kCancelled);
}

}  // namespace
}  // namespace fettle::engine
