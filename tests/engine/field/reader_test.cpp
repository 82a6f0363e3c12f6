#include "engine/field/reader.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "tests/support/no_data.h"

namespace fettle::engine {
namespace {

Grid gridOf(std::int32_t width, std::int32_t height) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  return grid;
}

// Any function of (column, row) that no permutation of samples leaves alone.
float someHeight(int column, int row) {
  return static_cast<float>(std::sin(column * 0.37) * 5.0 + std::cos(row * 0.11) * 3.0 +
                            (column * 31 + row * 17) % 7);
}

Version someField(int width, int height) {
  std::vector<float> z;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) z.push_back((c * 7 + r * 3) % 11 == 0 ? kNan : someHeight(c, r));
  return makeField(gridOf(width, height), z);
}

HeightBounds bruteBounds(const FieldReader& f, int side, int x, int y) {
  HeightBounds b{kInf, -kInf};
  for (int r = y * side; r < std::min((y + 1) * side, f.height()); ++r)
    for (int c = x * side; c < std::min((x + 1) * side, f.width()); ++c) {
      const float v = f.heightAt(c, r);
      if (std::isnan(v)) continue;
      b = {std::min(b.min, v), std::max(b.max, v)};
    }
  return b;
}

TEST(Reader, EverySampleComesBackFromFieldsOfOddSizes) {
  for (const auto& [w, h] : {std::pair{1, 1}, {1, 700}, {63, 2}, {64, 64}, {65, 129}, {521, 70}, {4097, 3}}) {
    const Version v = someField(w, h);
    for (int r = 0; r < h; ++r)
      for (int c = 0; c < w; ++c) {
        const float z = v.reader().heightAt(c, r);
        if ((c * 7 + r * 3) % 11 == 0)
          ASSERT_TRUE(std::isnan(z)) << c << ' ' << r;
        else
          ASSERT_EQ(z, someHeight(c, r)) << c << ' ' << r << " in " << w << " x " << h;
      }
  }
}

TEST(Reader, BoundsOfEverySquareEqualBruteForceAtEveryLevelAndSign) {
  for (const auto& [w, h] : {std::pair{1, 1}, {70, 530}, {4100, 9}})
    for (const bool inverted : {false, true}) {
      const Version v = inverted ? someField(w, h).inverted() : someField(w, h);
      const FieldReader f = v.reader();
      for (int level = 0, side = kBlockSide; level <= f.topLevel() + 1; ++level, side *= 8)
        for (int y = 0; y * side < h; ++y)
          for (int x = 0; x * side < w; ++x)
            ASSERT_EQ(f.bounds(level, x, y), bruteBounds(f, side, x, y)) << level << ' ' << x << ' ' << y;
    }
}

TEST(Reader, BoundsOutsideTheFieldAreEmpty) {
  const Version v = someField(70, 70);
  EXPECT_TRUE(v.reader().bounds(0, -1, 0).empty());
  EXPECT_TRUE(v.reader().bounds(0, 9, 0).empty());
  EXPECT_TRUE(v.reader().bounds(1, 0, 2).empty());
}

TEST(Reader, RectanglesReachingOutsideReadAsHolesAndUnmarked) {
  const Version v = makeField(gridOf(3, 2), {1, 2, 3, 4, 5, 6}, {1, 0, 0, 0, 0, 1});
  float z[5 * 4];
  std::uint8_t m[5 * 4];
  v.reader().readHeights(-1, -1, 5, 4, z, 5);
  v.reader().readMarks(-1, -1, 5, 4, m, 5);
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 5; ++c) {
      const bool inside = c >= 1 && c <= 3 && r >= 1 && r <= 2;
      if (!inside) {
        EXPECT_TRUE(std::isnan(z[r * 5 + c]));
        EXPECT_EQ(m[r * 5 + c], 0);
      } else {
        EXPECT_EQ(z[r * 5 + c], static_cast<float>((r - 1) * 3 + c));
        EXPECT_EQ(m[r * 5 + c], (c == 1 && r == 1) || (c == 3 && r == 2) ? 1 : 0);
      }
    }
}

TEST(Reader, InversionIsAnExactInvolution) {
  const Version v = someField(130, 67);
  const Version back = v.inverted().inverted();
  EXPECT_TRUE(back == v);
  EXPECT_EQ(contentHash(back), contentHash(v));
  EXPECT_NE(contentHash(v.inverted()), contentHash(v));
  EXPECT_EQ(v.inverted().reader().heightAt(1, 0), -v.reader().heightAt(1, 0));
}

TEST(Builder, InfinitiesBecomeHolesAndAreCounted) {
  Result<FieldBuilder> b = FieldBuilder::create(gridOf(2, 2), "test");
  const float z[] = {kInf, -kInf, kNan, 1e-42F};
  b->writeHeights(0, 0, 2, 2, z, 2);
  EXPECT_EQ(b->infinities(), 2);
  const Version v = std::move(*b).build();
  const FieldSummary s = summarize(v);
  EXPECT_EQ(s.no_data, 3);
  EXPECT_EQ(v.reader().heightAt(1, 1), 1e-42F);  // denormals keep their bits
}

TEST(Builder, RefusesSizesAndSpacingsThatCannotBe) {
  EXPECT_FALSE(FieldBuilder::create(gridOf(0, 5), "test"));
  EXPECT_FALSE(FieldBuilder::create(gridOf(5, Grid::kMaxSide + 1), "test"));
  Grid grid = gridOf(2, 2);
  grid.spacing_x = kNan;
  EXPECT_FALSE(FieldBuilder::create(grid, "test"));
  grid.spacing_x = -1;
  EXPECT_FALSE(FieldBuilder::create(grid, "test"));
}

TEST(Summary, CountsHolesAndMarksOnceEachWithoutThePadding) {
  const Version v = makeField(gridOf(3, 2), {1, kNan, 3, 4, 5, kNan}, {1, 1, 0, 0, 0, 0});
  const FieldSummary s = summarize(v.inverted());
  EXPECT_EQ(s.no_data, 2);
  EXPECT_EQ(s.marked, 2);
  EXPECT_EQ(s.min, -5);
  EXPECT_EQ(s.max, -1);
  EXPECT_EQ(s.mean, -13.0 / 4.0);
}

TEST(Summary, OfNothingButHolesIsNan) {
  const FieldSummary s = summarize(makeField(gridOf(2, 1), {kNan, kNan}));
  EXPECT_EQ(s.no_data, 2);
  EXPECT_TRUE(std::isnan(s.min) && std::isnan(s.max) && std::isnan(s.mean));
}

}  // namespace
}  // namespace fettle::engine
